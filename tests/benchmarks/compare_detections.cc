// Agreement of two databases of the same video; compare.sh prints it for the tracked against the
// exhaustive search.
// usage: compare_detections REFERENCE.db OTHER.db

#include <cstdio>
#include <exception>
#include <map>
#include <string>
#include <utility>

#include "importer/database/colmap_database.h"

namespace velamap {
namespace {

constexpr double kSamePx = 0.01;

// By image and marker.
using Detections = std::map<std::pair<std::string, int>, MarkerDetection>;

Detections ReadDetections(const std::string& path) {
  Detections detections;
  for (const DatabaseImage& image :
       ColmapDatabase(path, ColmapDatabase::Mode::kReadOnly).ReadImages()) {
    for (const MarkerDetection& marker : image.detections.markers) {
      detections[{image.detections.image_name, marker.marker_id}] = marker;
    }
  }
  return detections;
}

bool SameCorners(const MarkerDetection& a, const MarkerDetection& b) {
  for (std::size_t c = 0; c < kNumCorners; ++c) {
    if ((a.corners_in_image_px[c] - b.corners_in_image_px[c]).norm() > kSamePx) return false;
  }
  return true;
}

void Compare(const Detections& reference, const Detections& other) {
  int num_common = 0, num_same = 0;
  for (const auto& [key, marker] : reference) {
    const auto found = other.find(key);
    if (found == other.end()) continue;
    ++num_common;
    num_same += SameCorners(marker, found->second);
  }
  std::printf("reference: %zu\nother: %zu\nfound_again: %d\nsame_corners: %d\n", reference.size(),
              other.size(), num_common, num_same);
}

}  // namespace
}  // namespace velamap

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: compare_detections REFERENCE.db OTHER.db\n");
    return 2;
  }
  try {
    velamap::Compare(velamap::ReadDetections(argv[1]), velamap::ReadDetections(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  }
  return 0;
}
