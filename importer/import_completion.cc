#include "importer/import_completion.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/ranges.h>

#include "importer/base/log.h"
#include "importer/base/natural_order.h"
#include "importer/database/correspondence.h"
#include "importer/rotation/rotation_evidence.h"

namespace velamap {
namespace {

// Warns only of markers that were found: dictionaries have such codes that no print shows.
void WarnOfSymmetries(const FrameDetector& detector, const std::vector<FrameDetections>& frames) {
  std::set<int> ids;
  for (const FrameDetections& frame : frames) {
    for (const MarkerDetection& marker : frame.markers) {
      if (detector.symmetries.count(marker.marker_id) > 0) ids.insert(marker.marker_id);
    }
  }
  if (ids.empty()) return;
  LogWarning(
      "{}: markers that look the same when turned: {}; their neighbours number their corners",
      detector.dictionary.name, fmt::join(ids, " "));
}

}  // namespace

int ResolveDoubtfulRotations(const FrameDetector& detector, ColmapDatabase* database) {
  if (detector.symmetries.empty()) return 0;
  const std::vector<DatabaseImage> images = database->ReadImages();
  std::vector<FrameDetections> frames;
  for (const DatabaseImage& image : images) frames.push_back(image.detections);
  const std::vector<std::size_t> changed =
      ResolveRotationsAcrossFrames(detector.symmetries, detector.graph, &frames);
  WarnOfSymmetries(detector, frames);
  int num_resolved = 0;
  const std::string description = database->ReadDetector().value();
  ColmapDatabase::Transaction transaction(database);
  for (const std::size_t i : changed) {
    num_resolved += static_cast<int>(frames[i].markers.size()) -
                    static_cast<int>(images[i].detections.markers.size());
    database->ReplaceDetections(images[i].image_id, frames[i], description);
  }
  transaction.Commit();
  return num_resolved;
}

int WriteAllMatches(ColmapDatabase* database) {
  std::vector<DatabaseImage> images = database->ReadImages();
  std::sort(images.begin(), images.end(), [](const DatabaseImage& a, const DatabaseImage& b) {
    return NaturalLess(a.detections.image_name, b.detections.image_name);
  });
  std::vector<FrameDetections> frames;
  for (DatabaseImage& image : images) frames.push_back(std::move(image.detections));
  const std::vector<std::pair<int, int>> pairs = PairsToMatch(frames);
  ColmapDatabase::Transaction transaction(database);
  for (const auto& [first, second] : pairs) {
    const auto first_idx = static_cast<std::size_t>(first);
    const auto second_idx = static_cast<std::size_t>(second);
    const ImageId image_id1 = images[first_idx].image_id, image_id2 = images[second_idx].image_id;
    if (database->HasMatches(image_id1, image_id2)) continue;
    database->WriteMatches(image_id1, image_id2,
                           MatchByMarkerId(frames[first_idx], frames[second_idx]));
  }
  transaction.Commit();
  return static_cast<int>(pairs.size());
}

}  // namespace velamap
