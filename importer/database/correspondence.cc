#include "importer/database/correspondence.h"

#include <algorithm>
#include <map>
#include <set>

#include "importer/base/error.h"

namespace velamap {
namespace {

bool AreNeighbors(int distance) {
  constexpr int kOverlap = 4, kMaxDistance = 512;
  const bool is_power_of_two = (distance & (distance - 1)) == 0;
  return distance <= kOverlap || (is_power_of_two && distance <= kMaxDistance);
}

bool ShareMarker(const FrameDetections& image1, const FrameDetections& image2) {
  auto marker1 = image1.markers.begin(), marker2 = image2.markers.begin();
  while (marker1 != image1.markers.end() && marker2 != image2.markers.end()) {
    if (marker1->marker_id == marker2->marker_id) return true;
    marker1->marker_id < marker2->marker_id ? ++marker1 : ++marker2;
  }
  return false;
}

}  // namespace

Descriptor EncodeDescriptor(const CornerId& id) {
  constexpr int kNumSymbols = 32;
  VELAMAP_CHECK(id.marker_id >= 0 && id.marker_id <= kMaxMarkerId);
  VELAMAP_CHECK(id.corner >= 1 && id.corner <= kNumCorners);
  const int code = kNumCorners * id.marker_id + id.corner - 1;
  const int a = code % kNumSymbols;
  const int b = code / kNumSymbols % kNumSymbols;
  const int c = code / (kNumSymbols * kNumSymbols);
  const std::array<int, 4> symbols = {a, b, c, (a + b + c) % kNumSymbols};
  Descriptor descriptor{};
  for (int block = 0; block < 4; ++block) {
    descriptor[static_cast<std::size_t>(kNumSymbols * block + symbols[block])] = 255;
  }
  return descriptor;
}

FeatureMatches MatchByMarkerId(const FrameDetections& image1, const FrameDetections& image2) {
  FeatureMatches matches;
  matches.reserve(kNumCorners * std::min(image1.markers.size(), image2.markers.size()));
  std::uint32_t idx1 = 0, idx2 = 0;
  while (idx1 < image1.markers.size() && idx2 < image2.markers.size()) {
    const int id1 = image1.markers[idx1].marker_id, id2 = image2.markers[idx2].marker_id;
    if (id1 == id2) {
      for (std::uint32_t corner = 0; corner < kNumCorners; ++corner) {
        matches.emplace_back(kNumCorners * idx1 + corner, kNumCorners * idx2 + corner);
      }
    }
    idx1 += id1 <= id2;
    idx2 += id2 <= id1;
  }
  return matches;
}

std::vector<std::pair<int, int>> PairsToMatch(const std::vector<FrameDetections>& images) {
  const int num_images = static_cast<int>(images.size());
  std::set<std::pair<int, int>> pairs;
  for (int first = 0; first < num_images; ++first) {
    for (int second = first + 1; second < num_images; ++second) {
      if (num_images > kMaxNumExhaustive && !AreNeighbors(second - first)) continue;
      if (ShareMarker(images[static_cast<std::size_t>(first)],
                      images[static_cast<std::size_t>(second)])) {
        pairs.emplace(first, second);
      }
    }
  }
  std::map<int, int> last_idx_of_marker;
  for (int idx = 0; idx < num_images; ++idx) {
    for (const MarkerDetection& marker : images[static_cast<std::size_t>(idx)].markers) {
      const auto [last, is_first] = last_idx_of_marker.emplace(marker.marker_id, idx);
      if (!is_first) pairs.emplace(last->second, idx);
      last->second = idx;
    }
  }
  return {pairs.begin(), pairs.end()};
}

}  // namespace velamap
