#include "reconstruct/evidence/marker_clusters.h"

#include <algorithm>
#include <limits>
#include <map>

#include "importer/geometry/disjoint_sets.h"

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
  DisjointSets sets(rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (std::size_t j = i + 1; j < rest.size(); ++j) {
      if (are_near(i, j)) sets.Join(i, j);
    }
  }
  std::vector<MarkerChain> clusters;  // by their first markers
  std::map<std::size_t, std::size_t> cluster_of_set;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const auto [cluster, is_new] = cluster_of_set.try_emplace(sets.Find(i), clusters.size());
    if (is_new) clusters.emplace_back();
    clusters[cluster->second].push_back(rest[i]);
  }
  return clusters;
}

}  // namespace velamap
