#include "workflows/proposal/rare_ids.h"

#include <utility>

#include "importer/base/statistics.h"

namespace velamap {

std::map<int, int> CountFramesOfIds(const std::vector<DatabaseImage>& images) {
  std::map<int, int> num_frames_of_id;
  for (const DatabaseImage& image : images) {
    std::set<int> ids;
    for (const MarkerDetection& marker : image.detections.markers) ids.insert(marker.marker_id);
    for (const RejectedDetection& rejected : image.detections.rejected) {
      ids.insert(rejected.detection.marker_id);
    }
    for (const int marker_id : ids) ++num_frames_of_id[marker_id];
  }
  return num_frames_of_id;
}

std::set<int> FindRareIds(const std::map<int, int>& num_frames_of_id) {
  constexpr double kSeldom = 0.2;  // of the median
  std::vector<double> nums;
  for (const auto& [marker_id, num_frames] : num_frames_of_id) {
    if (num_frames > 1) nums.push_back(num_frames);
  }
  if (nums.empty()) return {};
  const double least = kSeldom * Median(std::move(nums));
  std::set<int> rare;
  for (const auto& [marker_id, num_frames] : num_frames_of_id) {
    if (num_frames < least) rare.insert(marker_id);
  }
  return rare;
}

}  // namespace velamap
