#include "importer/detect/duplicates.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace velamap {
namespace {

constexpr std::size_t kNumNeighbors = 3;

// A total order, so that the result does not depend on the order of the input.
bool ComesBefore(const MarkerDetection& a, const MarkerDetection& b) {
  if (a.marker_id != b.marker_id) return a.marker_id < b.marker_id;
  for (int i = 0; i < kNumCorners; ++i) {
    for (int axis = 0; axis < 2; ++axis) {
      const double x = a.corners_in_image_px[i][axis], y = b.corners_in_image_px[i][axis];
      if (x != y) return x < y;
    }
  }
  return false;
}

// Centres of the topologically nearest markers that were found once; ties go to the smaller id.
std::vector<Eigen::Vector2d> NearestUniqueNeighbors(
    int marker_id, const AdjacencyGraph& graph,
    const std::map<int, std::vector<MarkerDetection>>& candidates_by_id) {
  std::vector<std::pair<int, int>> neighbors;  // distance, id
  for (const auto& [other_id, distance] : TopologicalDistances(graph, marker_id)) {
    const auto found = candidates_by_id.find(other_id);
    if (other_id == marker_id || found == candidates_by_id.end()) continue;
    if (found->second.size() == 1) neighbors.emplace_back(distance, other_id);
  }
  std::sort(neighbors.begin(), neighbors.end());
  if (neighbors.size() > kNumNeighbors) neighbors.resize(kNumNeighbors);
  std::vector<Eigen::Vector2d> centers;
  for (const auto& [distance, id] : neighbors) {
    centers.push_back(CornerMean(candidates_by_id.at(id).front()));
  }
  return centers;
}

double MeanDistance(const Eigen::Vector2d& center, const std::vector<Eigen::Vector2d>& others) {
  double sum = 0.0;
  for (const Eigen::Vector2d& other : others) sum += (center - other).norm();
  return sum / static_cast<double>(others.size());
}

}  // namespace

ResolvedDetections ResolveDuplicates(std::vector<MarkerDetection> candidates,
                                     const AdjacencyGraph& graph) {
  std::sort(candidates.begin(), candidates.end(), ComesBefore);
  std::map<int, std::vector<MarkerDetection>> candidates_by_id;
  for (MarkerDetection& candidate : candidates) {
    candidates_by_id[candidate.marker_id].push_back(std::move(candidate));
  }
  ResolvedDetections result;
  for (const auto& [marker_id, rivals] : candidates_by_id) {
    if (rivals.size() == 1) {
      result.markers.push_back(rivals.front());
      continue;
    }
    const std::vector<Eigen::Vector2d> neighbors =
        NearestUniqueNeighbors(marker_id, graph, candidates_by_id);
    if (neighbors.empty()) {
      for (const MarkerDetection& rival : rivals) {
        result.rejected.push_back({rival, "duplicated id, no neighbour tells which is right"});
      }
      continue;
    }
    std::size_t best_idx = 0;
    double best_distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < rivals.size(); ++i) {
      const double distance = MeanDistance(CornerMean(rivals[i]), neighbors);
      if (distance < best_distance) {
        best_distance = distance;
        best_idx = i;
      }
    }
    result.markers.push_back(rivals[best_idx]);
    for (std::size_t i = 0; i < rivals.size(); ++i) {
      if (i == best_idx) continue;
      result.rejected.push_back({rivals[i], "duplicated id, further from its neighbours"});
    }
  }
  return result;
}

}  // namespace velamap
