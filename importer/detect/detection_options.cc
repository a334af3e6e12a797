#include "importer/detect/detection_options.h"

namespace velamap {
namespace {

const Choices<CornerRefinement> kRefinements = {{CornerRefinement::kNone, "none"},
                                                {CornerRefinement::kSubpix, "subpix"},
                                                {CornerRefinement::kEdge, "edge"}};

const Choices<SearchMode> kSearchModes = {{SearchMode::kTracked, "tracked"},
                                          {SearchMode::kExhaustive, "exhaustive"}};

}  // namespace

std::string CornerRefinementName(CornerRefinement refinement) {
  return ChoiceName(kRefinements, refinement);
}

std::string SearchModeName(SearchMode mode) { return ChoiceName(kSearchModes, mode); }

OptionGroup DescribeOptions(ArucoDetectionOptions* options) {
  return {
      "Marker detection",
      {ChoiceOption("ArucoDetection.corner_refinement", &options->corner_refinement, kRefinements,
                    "how corners get sub-pixel accuracy; subpix pulls them inwards"),
       {"ArucoDetection.min_marker_perimeter_rate", &options->min_marker_perimeter_rate, "fraction",
        "smallest perimeter of a marker, relative to the larger image side", FromTo(0.001, 4)},
       {"ArucoDetection.error_correction_rate", &options->error_correction_rate, "fraction",
        "part of the dictionary's error correction that is used", FromTo(0, 1)},
       {"ArucoDetection.estimate_formation", &options->estimate_formation, "0|1",
        "edge: estimate from the first frames how the camera's tone curve, its sharpening and the "
        "print's ink move edges; 0: assume linear pictures and a perfect print"},
       {"ArucoDetection.inverted", &options->inverted, "0|1", "white markers on black ground"},
       ChoiceOption("ArucoDetection.search", &options->search, kSearchModes,
                    "where to search in a video: around the markers of the previous frames, or "
                    "everywhere; photographs are always searched everywhere"),
       {"ArucoDetection.full_search_interval", &options->full_search_interval, "frames",
        "tracked: every k-th frame is searched everywhere", AtLeast(1)}}};
}

void ArucoDetectionOptions::Check() const { CheckRanges(*this); }

}  // namespace velamap
