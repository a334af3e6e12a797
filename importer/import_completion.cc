#include "importer/import_completion.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "importer/base/natural_order.h"
#include "importer/database/correspondence.h"
#include "importer/detect/rotation_evidence.h"

namespace velamap {

int ResolveDoubtfulRotations(const FrameDetector& detector, ColmapDatabase* database) {
  if (detector.symmetries.empty()) return 0;
  const std::vector<DatabaseImage> images = database->ReadImages();
  std::vector<FrameDetections> frames;
  for (const DatabaseImage& image : images) frames.push_back(image.detections);
  const std::vector<std::size_t> changed =
      ResolveRotationsAcrossFrames(detector.symmetries, detector.graph, &frames);
  int num_resolved = 0;
  ColmapDatabase::Transaction transaction(database);
  for (const std::size_t i : changed) {
    num_resolved += static_cast<int>(frames[i].markers.size()) -
                    static_cast<int>(images[i].detections.markers.size());
    database->ReplaceDetections(images[i].image_id, frames[i], DescribeDetector(detector));
  }
  transaction.Commit();
  return num_resolved;
}

int WriteAllMatches(ColmapDatabase* database) {
  std::vector<DatabaseImage> images = database->ReadImages();
  std::sort(images.begin(), images.end(), [](const DatabaseImage& a, const DatabaseImage& b) {
    return NaturalLess(a.detections.image_name, b.detections.image_name);
  });
  const std::vector<std::pair<int, int>> pairs = PairsToMatch(static_cast<int>(images.size()));
  int num_pairs = 0;
  ColmapDatabase::Transaction transaction(database);
  for (const auto& [first_idx, second_idx] : pairs) {
    const DatabaseImage& first = images[static_cast<std::size_t>(first_idx)];
    const DatabaseImage& second = images[static_cast<std::size_t>(second_idx)];
    const FeatureMatches matches = MatchByMarkerId(first.detections, second.detections);
    if (matches.empty()) continue;
    ++num_pairs;
    if (!database->HasMatches(first.image_id, second.image_id)) {
      database->WriteMatches(first.image_id, second.image_id, matches);
    }
  }
  transaction.Commit();
  return num_pairs;
}

}  // namespace velamap
