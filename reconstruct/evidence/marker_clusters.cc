#include "reconstruct/evidence/marker_clusters.h"

#include <algorithm>
#include <limits>

namespace velamap {
namespace {

// Two markers are linked if their distance is at most this many times the smaller of the distances
// to their nearest neighbours.
constexpr double kMaxTimesNearest = 2.5;

}  // namespace

std::vector<MarkerChain> FindClusters(const std::vector<OrientedMarker>& markers,
                                      const MarkerChain& rest) {
  std::vector<double> nearest(rest.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (std::size_t j = 0; j < rest.size(); ++j) {
      if (i != j) nearest[i] = std::min(nearest[i], Distance(markers[rest[i]], markers[rest[j]]));
    }
  }
  const auto are_near = [&](std::size_t i, std::size_t j) {
    return Distance(markers[rest[i]], markers[rest[j]]) <=
           kMaxTimesNearest * std::min(nearest[i], nearest[j]);
  };
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> cluster_of(rest.size(), kNone);
  std::size_t num_clusters = 0;
  for (std::size_t first = 0; first < rest.size(); ++first) {
    if (cluster_of[first] != kNone) continue;
    std::vector<std::size_t> open{first};
    cluster_of[first] = num_clusters;
    while (!open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      for (std::size_t j = 0; j < rest.size(); ++j) {
        if (cluster_of[j] != kNone || !are_near(i, j)) continue;
        cluster_of[j] = num_clusters;
        open.push_back(j);
      }
    }
    ++num_clusters;
  }
  std::vector<MarkerChain> clusters(num_clusters);
  for (std::size_t i = 0; i < rest.size(); ++i) clusters[cluster_of[i]].push_back(rest[i]);
  return clusters;
}

}  // namespace velamap
