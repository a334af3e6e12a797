#include "workflows/proposal/print_faults.h"

#include <algorithm>
#include <iterator>
#include <set>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "importer/detect/marker_search.h"
#include "importer/layout/dictionary.h"
#include "importer/text/id_ranges.h"

namespace velamap {
namespace {

constexpr int kMinPrintFrames = 2;

bool IsOneOf(const MarkerQuad& quad, const std::vector<MarkerDetection>& markers) {
  const Eigen::Vector2d center_px = QuadCenter(quad.corners_px);
  return std::any_of(markers.begin(), markers.end(), [&](const MarkerDetection& marker) {
    return (CornerMean(marker) - center_px).norm() < QuadMeanSide(marker.corners_in_image_px);
  });
}

}  // namespace

PrintFaults FindPrintFaults(const std::vector<Frame>& frames,
                            const std::map<std::string, const FrameDetections*>& found,
                            const Layout& layout, const ArucoDetectionOptions& detection) {
  ArucoDetectionOptions strict = detection;
  // No other evidence confirms these codes, so none of their bits may be wrong.
  strict.error_correction_rate = 0.0;
  strict.search = SearchMode::kExhaustive;
  const Dictionary dictionary = LoadDictionary(layout.dictionary);
  const std::vector<int> named = MarkerIds(layout);
  const auto search = [&](const Frame& frame, const cv::Mat& changed, bool is_mirrored,
                          std::map<int, int>* counts) {
    const auto detections = found.find(frame.image_name);
    std::set<int> ids;
    for (MarkerQuad& quad : SearchMarkers(changed, dictionary, layout.border_bits, strict)) {
      if (!named.empty() && !std::binary_search(named.begin(), named.end(), quad.marker_id))
        continue;
      if (is_mirrored) {
        for (Eigen::Vector2d& x_px : quad.corners_px) x_px.x() = frame.gray.cols - x_px.x();
      }
      if (detections != found.end() && IsOneOf(quad, detections->second->markers)) continue;
      ids.insert(quad.marker_id);
    }
    for (const int id : ids) ++(*counts)[id];
  };
  PrintFaults faults;
  for (const Frame& frame : frames) {
    cv::Mat changed;
    cv::flip(frame.gray, changed, 1);
    search(frame, changed, true, &faults.mirrored);
    cv::bitwise_not(frame.gray, changed);
    search(frame, changed, false, &faults.inverted);
  }
  for (std::map<int, int>* counts : {&faults.mirrored, &faults.inverted}) {
    for (auto it = counts->begin(); it != counts->end();) {
      it = it->second < kMinPrintFrames ? counts->erase(it) : std::next(it);
    }
  }
  return faults;
}

std::vector<std::string> DescribeFaults(const PrintFaults& faults, int num_markers,
                                        int num_frames) {
  constexpr std::size_t kMany = 4;
  std::vector<std::string> lines;
  const auto describe = [&](const std::map<int, int>& counts, const std::string& how,
                            const std::string& remedy_for_all) {
    if (counts.size() >= kMany && counts.size() >= static_cast<std::size_t>(num_markers)) {
      std::vector<int> ids;
      for (const auto& [marker_id, count] : counts) ids.push_back(marker_id);
      lines.push_back(fmt::format("markers {} are {}: {}", IdRanges(ids), how, remedy_for_all));
      return;
    }
    for (const auto& [marker_id, count] : counts) {
      lines.push_back(fmt::format("marker {} is {}, as {} of {} frames show: print it again",
                                  marker_id, how, count, num_frames));
    }
  };
  describe(faults.mirrored, "mirrored", "print them again, or film without mirroring");
  describe(faults.inverted, "printed with black and white exchanged",
           "print them again, or set " + OptionName(&ArucoDetectionOptions::inverted));
  return lines;
}

}  // namespace velamap
