#include "reconstruct/sizes/marker_curvature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

// A marker with four corners as a piece of the surface. Its axes run along the sides from corner 1
// to 2 and from 4 to 1.
struct Facet {
  Eigen::Vector3d center_m;
  Eigen::Matrix3d world_from_facet;
};

std::optional<Facet> FacetOf(const MarkerBlock& marker) {
  if (marker.corners.size() != kNumCorners) return std::nullopt;
  std::array<Eigen::Vector3d, kNumCorners> x;
  Facet facet{Eigen::Vector3d::Zero(), {}};
  for (int i = 0; i < kNumCorners; ++i) {
    x[static_cast<std::size_t>(i)] = CornerPosition(marker, i);
    facet.center_m += x[static_cast<std::size_t>(i)] / kNumCorners;
  }
  const Eigen::Vector3d right = x[1] - x[0] + x[2] - x[3], up = x[0] - x[3] + x[1] - x[2];
  const Eigen::Vector3d normal = right.cross(up).normalized();
  facet.world_from_facet << right.normalized(), normal.cross(right.normalized()), normal;
  if (!facet.world_from_facet.allFinite()) return std::nullopt;
  return facet;
}

// Second derivatives of the height of the surface above a marker, 1/m: xx, xy, yy.
struct Curvature {
  Eigen::Vector3d second_1_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();

  // Square of the curvature along a direction in the plane of the marker, less its variance.
  double SquareAlong(const Eigen::Vector2d& direction) const {
    const Eigen::Vector3d by_second(direction.x() * direction.x(),
                                    2 * direction.x() * direction.y(),
                                    direction.y() * direction.y());
    const double value = by_second.dot(second_1_m);
    return std::max(0.0, value * value - by_second.dot(covariance * by_second));
  }
};

// The quadratic surface through a marker that explains the neighbours. Their tilts and heights,
// divided by their distances, are taken to be equally exact.
std::optional<Curvature> CurvatureOf(const Facet& facet, const std::vector<Facet>& neighbors) {
  constexpr double kMinCosine = 0.85;      // of the angle between neighbours; farther ones are on
                                           // another face
  constexpr double kMaxUnexplained = 0.3;  // of the squares
  constexpr double kRidge = 1e-3;          // holds what neighbours in one line leave open
  constexpr int kMinObservations = 6;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double squares = 0.0;
  int count = 0;
  const auto add = [&](const Eigen::Vector3d& by_second, double value) {
    normal += by_second * by_second.transpose();
    right += by_second * value;
    squares += value * value;
    ++count;
  };
  for (const Facet& neighbor : neighbors) {
    const Eigen::Vector3d place =
        facet.world_from_facet.transpose() * (neighbor.center_m - facet.center_m);
    const Eigen::Vector3d axis =
        facet.world_from_facet.transpose() * neighbor.world_from_facet.col(2);
    const double distance = place.head<2>().norm();
    if (!(axis.z() > kMinCosine) || !(distance > std::abs(place.z()))) continue;
    const double x = place.x() / distance, y = place.y() / distance;
    add({x, y, 0}, -axis.x() / distance);
    add({0, x, y}, -axis.y() / distance);
    add({x * x, 2 * x * y, y * y}, 2 * place.z() / (distance * distance));
  }
  if (count < kMinObservations) return std::nullopt;
  normal.diagonal().array() += kRidge * count;
  const Eigen::Matrix3d inverse = normal.llt().solve(Eigen::Matrix3d::Identity());
  Curvature curvature;
  curvature.second_1_m = inverse * right;
  const double unexplained = squares - right.dot(curvature.second_1_m);
  if (!(unexplained < kMaxUnexplained * squares)) return std::nullopt;
  curvature.covariance = std::max(0.0, unexplained) / std::max(1, count - 3) * inverse;
  return curvature;
}

}  // namespace

ChordSummary SetChords(MarkerState* state) {
  constexpr double kReachSides = 4.0;
  constexpr double kMaxShortening = 0.1;
  // Paper may stay flat on a surface that bends less, and the print tolerance is larger than the
  // shortening of such a side, 0.04 %.
  constexpr double kMinBend = 0.1;  // side by radius
  std::vector<std::optional<Facet>> facets;
  for (const MarkerBlock& marker : state->markers) facets.push_back(FacetOf(marker));
  ChordSummary summary;
  int num_markers = 0;
  for (std::size_t i = 0; i < state->markers.size(); ++i) {
    MarkerBlock& marker = state->markers[i];
    marker.chord_ratios.fill(1.0);
    ++num_markers;
    if (!facets[i] || marker.is_rigid) continue;
    std::vector<Facet> neighbors;
    for (std::size_t j = 0; j < facets.size(); ++j) {
      if (j == i || !facets[j] || state->markers[j].part != marker.part) continue;
      if ((facets[j]->center_m - facets[i]->center_m).norm() < kReachSides * marker.length_m) {
        neighbors.push_back(*facets[j]);
      }
    }
    const auto curvature = CurvatureOf(*facets[i], neighbors);
    if (!curvature) continue;
    double shortening = 0.0;
    for (std::size_t side = 0; side < kNumCorners; ++side) {
      const Eigen::Vector2d along =
          side % 2 == 0 ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY();
      const double squared_bend = marker.length_m * marker.length_m * curvature->SquareAlong(along);
      if (squared_bend < kMinBend * kMinBend) continue;
      const double of_side = std::min(kMaxShortening, squared_bend / 24);
      marker.chord_ratios[side] = 1 - of_side;
      shortening += of_side / kNumCorners;
    }
    summary.mean_shortening += shortening;
    if (shortening > summary.largest_shortening) {
      summary.largest_shortening = shortening;
      summary.marker_id = marker.marker_id;
    }
  }
  if (num_markers > 0) summary.mean_shortening /= num_markers;
  return summary;
}

}  // namespace velamap
