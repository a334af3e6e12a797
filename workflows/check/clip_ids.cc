#include "workflows/check/clip_ids.h"

#include <map>
#include <set>
#include <vector>

#include "importer/detect/detection.h"
#include "workflows/proposal/rare_ids.h"

namespace velamap {
namespace {

void CollectUnseenBetweenSeen(const MarkerLine& line, const std::map<int, int>& num_frames_of_id,
                              std::set<int>* ids) {
  std::vector<int> unseen;
  bool is_behind_seen = false;
  for (const int marker_id : line.marker_ids) {
    if (num_frames_of_id.count(marker_id) == 0) {
      unseen.push_back(marker_id);
      continue;
    }
    if (is_behind_seen) ids->insert(unseen.begin(), unseen.end());
    unseen.clear();
    is_behind_seen = true;
  }
}

}  // namespace

void CollectIds(const std::vector<DatabaseImage>& images, const Layout& layout, ClipFacts* facts) {
  const std::map<int, int> num_frames_of_id = CountFramesOfIds(images);
  const std::set<int> rare = FindRareIds(num_frames_of_id);
  std::set<int> foreign;
  for (const DatabaseImage& image : images) {
    for (const MarkerDetection& marker : image.detections.markers) {
      // Without the ids of a layout, rarity alone distinguishes a misread id from a marker.
      if (!layout.HasMarkers() && rare.count(marker.marker_id) > 0) continue;
      ++facts->num_frames_of_id[marker.marker_id];
    }
    for (const RejectedDetection& rejected : image.detections.rejected) {
      if (rejected.reason == kNotInLayout) foreign.insert(rejected.detection.marker_id);
    }
  }
  if (!layout.HasMarkers()) facts->ids_read_rarely.assign(rare.begin(), rare.end());
  for (const int marker_id : foreign) {
    const bool is_doubtful = rare.count(marker_id) > 0 || num_frames_of_id.at(marker_id) == 1;
    (is_doubtful ? facts->ids_read_rarely : facts->ids_not_in_layout).push_back(marker_id);
  }
  for (const int marker_id : MarkerIds(layout)) {
    if (facts->num_frames_of_id.count(marker_id) == 0) facts->ids_never_seen.push_back(marker_id);
  }
  std::set<int> between;
  for (const LayoutPart& part : layout.parts) {
    for (const auto* lines : {&part.horizontal, &part.vertical}) {
      for (const MarkerLine& line : *lines) {
        CollectUnseenBetweenSeen(line, facts->num_frames_of_id, &between);
      }
    }
  }
  facts->ids_unseen_between_seen.assign(between.begin(), between.end());
}

}  // namespace velamap
