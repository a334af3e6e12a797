#include "importer/detect/detection_options.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr std::array<std::pair<CornerRefinement, const char*>, 3> kRefinements = {
    {{CornerRefinement::kNone, "none"},
     {CornerRefinement::kSubpix, "subpix"},
     {CornerRefinement::kEdge, "edge"}}};

constexpr std::array<std::pair<SearchMode, const char*>, 2> kSearchModes = {
    {{SearchMode::kExhaustive, "exhaustive"}, {SearchMode::kTracked, "tracked"}}};

// Written so that NaN fails the test.
void CheckRange(const char* option, double value, double min, double max) {
  if (!(value >= min && value <= max)) {
    throw InputError(
        fmt::format("--{}: {} is out of range; give {} to {}", option, value, min, max));
  }
}

}  // namespace

CornerRefinement CornerRefinementFromName(const std::string& name) {
  for (const auto& [refinement, known_name] : kRefinements) {
    if (name == known_name) return refinement;
  }
  throw InputError(fmt::format(
      "--ArucoDetection.corner_refinement: '{}' is unknown; give none, subpix or edge", name));
}

std::string CornerRefinementName(CornerRefinement refinement) {
  for (const auto& [known_refinement, name] : kRefinements) {
    if (refinement == known_refinement) return name;
  }
  throw std::logic_error("unknown corner refinement");
}

SearchMode SearchModeFromName(const std::string& name) {
  for (const auto& [mode, known_name] : kSearchModes) {
    if (name == known_name) return mode;
  }
  throw InputError(
      fmt::format("--ArucoDetection.search: '{}' is unknown; give tracked or exhaustive", name));
}

std::string SearchModeName(SearchMode mode) {
  for (const auto& [known_mode, name] : kSearchModes) {
    if (mode == known_mode) return name;
  }
  throw std::logic_error("unknown search mode");
}

void ArucoDetectionOptions::Check() const {
  CheckRange("ArucoDetection.min_marker_perimeter_rate", min_marker_perimeter_rate, 0.001, 4.0);
  CheckRange("ArucoDetection.error_correction_rate", error_correction_rate, 0.0, 1.0);
  if (full_search_interval < 1) {
    throw InputError(
        fmt::format("--ArucoDetection.full_search_interval: {} is too small; give 1 or more",
                    full_search_interval));
  }
}

}  // namespace velamap
