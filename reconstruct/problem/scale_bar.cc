#include "reconstruct/problem/scale_bar.h"

#include <algorithm>
#include <utility>

namespace velamap {
namespace {

// Vector from the first point of the bar to the second.
Eigen::Vector3d BarVector(const ScaleBar& bar, const MarkerState& state) {
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  for (std::size_t block = 0; block < bar.marker_idxs.size(); ++block) {
    const MarkerBlock& marker = state.markers[bar.marker_idxs[block]];
    for (std::size_t slot = 0; slot < marker.corners.size(); ++slot) {
      vector += bar.corner_weights[block][slot] * CornerPosition(marker, static_cast<int>(slot));
    }
  }
  return vector;
}

// Adds one end of a bar. Returns false if corners of it are missing.
bool AddEnd(const MarkerState& state, int marker_id, int corner, double sign, ScaleBar* bar) {
  const auto marker =
      std::find_if(state.markers.begin(), state.markers.end(),
                   [marker_id](const MarkerBlock& other) { return other.marker_id == marker_id; });
  if (marker == state.markers.end()) return false;
  if (corner == 0 && marker->corners.size() != kNumCorners) return false;
  std::vector<double> weights(marker->corners.size(), 0.0);
  if (corner == 0) {
    std::fill(weights.begin(), weights.end(), sign / kNumCorners);
  } else {
    const auto it = std::find(marker->corners.begin(), marker->corners.end(), corner);
    if (it == marker->corners.end()) return false;
    weights[it - marker->corners.begin()] = sign;
  }
  const int marker_idx = static_cast<int>(marker - state.markers.begin());
  if (!bar->marker_idxs.empty() && bar->marker_idxs.front() == marker_idx) {
    for (std::size_t i = 0; i < weights.size(); ++i) bar->corner_weights.front()[i] += weights[i];
    return true;
  }
  bar->marker_idxs.push_back(marker_idx);
  bar->corner_weights.push_back(std::move(weights));
  return true;
}

}  // namespace

std::vector<ScaleBar> FindScaleBars(const MarkerState& state,
                                    const std::vector<KnownDistance>& distances) {
  std::vector<ScaleBar> bars;
  for (const KnownDistance& distance : distances) {
    if (!distance.is_scale_bar) continue;
    ScaleBar bar;
    bar.distance = distance;
    if (AddEnd(state, distance.marker_id1, distance.corner1, -1.0, &bar) &&
        AddEnd(state, distance.marker_id2, distance.corner2, 1.0, &bar)) {
      bars.push_back(std::move(bar));
    }
  }
  return bars;
}

Eigen::VectorXd BarGradient(const ScaleBar& bar, const MarkerState& state) {
  const Eigen::Vector3d direction = BarVector(bar, state).normalized();
  std::vector<Eigen::Index> begins = {0};
  for (const MarkerBlock& marker : state.markers) {
    begins.push_back(begins.back() + marker.NumCoordinates());
  }
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(begins.back());
  for (std::size_t block = 0; block < bar.marker_idxs.size(); ++block) {
    const std::vector<double>& weights = bar.corner_weights[block];
    for (std::size_t slot = 0; slot < weights.size(); ++slot) {
      gradient.segment<3>(begins[bar.marker_idxs[block]] + 3 * static_cast<Eigen::Index>(slot)) =
          weights[slot] * direction;
    }
  }
  return gradient;
}

double BarLength(const ScaleBar& bar, const MarkerState& state) {
  return BarVector(bar, state).norm();
}

}  // namespace velamap
