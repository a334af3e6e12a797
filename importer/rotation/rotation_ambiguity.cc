#include "importer/rotation/rotation_ambiguity.h"

#include <algorithm>
#include <utility>

#include <opencv2/core.hpp>

namespace velamap {
namespace {

constexpr std::size_t kNumNearest = 3;

// The best turn must exceed the second best by this margin of the mean cosine between top sides. A
// marker with half turns is then within 75 degrees of its neighbours, one with quarter turns within
// 24.
constexpr double kMinLead = 0.5;

// Unit vector along the top side, from corner 1 to corner 2, after `turn` quarter turns.
Eigen::Vector2d TopSide(const MarkerDetection& marker, int turn) {
  const auto& corners = marker.corners_in_image_px;
  const std::size_t first = static_cast<std::size_t>(turn);
  return (corners[(first + 1) % kNumCorners] - corners[first]).normalized();
}

std::vector<const MarkerDetection*> NearestUnambiguous(
    const MarkerDetection& marker, const CodeSymmetries& symmetries, const AdjacencyGraph& graph,
    const std::vector<MarkerDetection>& markers) {
  const std::map<int, int> steps = TopologicalDistances(graph, marker.marker_id);
  std::vector<std::pair<double, const MarkerDetection*>> by_steps, by_distance;
  for (const MarkerDetection& other : markers) {
    if (symmetries.count(other.marker_id) > 0) continue;
    const auto found = steps.find(other.marker_id);
    if (found != steps.end()) by_steps.emplace_back(found->second, &other);
    by_distance.emplace_back((CornerMean(other) - CornerMean(marker)).norm(), &other);
  }
  auto& nearest = by_steps.empty() ? by_distance : by_steps;
  std::sort(nearest.begin(), nearest.end(), [](const auto& a, const auto& b) {
    return std::make_pair(a.first, a.second->marker_id) <
           std::make_pair(b.first, b.second->marker_id);
  });
  std::vector<const MarkerDetection*> neighbors;
  for (std::size_t i = 0; i < std::min(nearest.size(), kNumNearest); ++i) {
    neighbors.push_back(nearest[i].second);
  }
  return neighbors;
}

// The turn that fits the neighbours best, or -1 where they do not decide.
int ChooseTurn(const MarkerDetection& marker, const std::vector<int>& possible_turns,
               const std::vector<const MarkerDetection*>& neighbors) {
  if (neighbors.empty()) return -1;
  std::vector<std::pair<double, int>> scores;
  const auto add = [&](int turn) {
    double sum = 0.0;
    for (const MarkerDetection* other : neighbors) {
      sum += TopSide(marker, turn).dot(TopSide(*other, 0));
    }
    scores.emplace_back(sum / static_cast<double>(neighbors.size()), turn);
  };
  add(0);
  for (const int turn : possible_turns) add(turn);
  std::sort(scores.rbegin(), scores.rend());
  return scores[0].first - scores[1].first >= kMinLead ? scores[0].second : -1;
}

}  // namespace

MarkerDetection Turned(const MarkerDetection& marker, int turn) {
  MarkerDetection turned = marker;
  const auto rotate = [turn](const auto& of_corners, auto* rotated) {
    std::rotate_copy(of_corners.begin(), of_corners.begin() + turn, of_corners.end(),
                     rotated->begin());
  };
  rotate(marker.corners_in_image_px, &turned.corners_in_image_px);
  rotate(marker.colors, &turned.colors);
  rotate(marker.corner_sigma_px, &turned.corner_sigma_px);
  return turned;
}

CodeSymmetries FindCodeSymmetries(const Dictionary& dictionary) {
  CodeSymmetries symmetries;
  for (int id = 0; id < NumMarkers(dictionary); ++id) {
    const cv::Mat bits = MarkerBits(dictionary, id);
    cv::Mat turned = bits.clone();
    for (int turn = 1; turn < kNumCorners; ++turn) {
      cv::rotate(turned, turned, cv::ROTATE_90_CLOCKWISE);
      if (cv::countNonZero(turned != bits) == 0) symmetries[id].push_back(turn);
    }
  }
  return symmetries;
}

void ResolveRotations(const CodeSymmetries& symmetries, const AdjacencyGraph& graph,
                      std::vector<MarkerDetection>* markers,
                      std::vector<RejectedDetection>* rejected) {
  if (symmetries.empty()) return;
  std::vector<MarkerDetection> resolved;
  for (const MarkerDetection& marker : *markers) {
    const auto symmetry = symmetries.find(marker.marker_id);
    if (symmetry == symmetries.end()) {
      resolved.push_back(marker);
      continue;
    }
    const int turn = ChooseTurn(marker, symmetry->second,
                                NearestUnambiguous(marker, symmetries, graph, *markers));
    if (turn >= 0) {
      resolved.push_back(Turned(marker, turn));
    } else {
      rejected->push_back({marker, kDoubtfulRotation});
    }
  }
  *markers = std::move(resolved);
}

}  // namespace velamap
