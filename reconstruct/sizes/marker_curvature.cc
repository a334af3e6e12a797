#include "reconstruct/sizes/marker_curvature.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "importer/geometry/alignment.h"
#include "reconstruct/geometry/marker_pose.h"

namespace velamap {
namespace {

// Second derivatives of the height of the surface above a marker, 1/m: xx, xy, yy.
struct Curvature {
  Eigen::Vector3d second_1_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();

  Eigen::Matrix2d Matrix() const {
    Eigen::Matrix2d matrix;
    matrix << second_1_m.x(), second_1_m.y(), second_1_m.y(), second_1_m.z();
    return matrix;
  }

  // As in MarkerChords.
  double DiagonalsDifference(double side_m) const {
    const double from1_to3 = SquaredBend({side_m, -side_m}, side_m);
    const double from2_to4 = SquaredBend({side_m, side_m}, side_m);
    return std::sqrt(2.0) * (from2_to4 - from1_to3) / 24;
  }

  // Square of the bend of a line on the marker, as an angle, minus its variance. The mean of a bent
  // marker's corners lies inside the surface, by the sagittas of its two sides, so the places of
  // the neighbours show a radius that is too small.
  double SquaredBend(const Eigen::Vector2d& line_m, double side_m) const {
    const Eigen::Vector2d direction = line_m.normalized();
    const Eigen::Vector3d by_second(direction.x() * direction.x(),
                                    2 * direction.x() * direction.y(),
                                    direction.y() * direction.y());
    const double value = by_second.dot(second_1_m);
    const double inside_m = (second_1_m.x() + second_1_m.z()) * side_m * side_m / 8;
    const double square = value * value * (1 - 2 * value * inside_m);
    return line_m.squaredNorm() * std::max(0.0, square - by_second.dot(covariance * by_second));
  }
};

// The surface of constant curvature through a marker that fits the neighbours best. Their tilts,
// and their heights divided by their distances, count as equally precise.
std::optional<Curvature> CurvatureOf(const Rigid3& world_from_facet,
                                     const std::vector<Rigid3>& world_from_neighbors) {
  constexpr double kMinCosine = 0.64;      // of the angle between neighbours, 50 degrees; others
                                           // are on another face
  constexpr double kMaxUnexplained = 0.3;  // of the squares
  constexpr double kRidge = 1e-3;          // for what neighbours in one line leave open
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
  const Rigid3 facet_from_world = Inverse(world_from_facet);
  for (const Rigid3& world_from_neighbor : world_from_neighbors) {
    const Rigid3 facet_from_neighbor = facet_from_world * world_from_neighbor;
    const Eigen::Vector3d& place = facet_from_neighbor.translation;
    const Eigen::Vector3d axis = facet_from_neighbor.rotation * Eigen::Vector3d::UnitZ();
    const double distance = place.head<2>().norm();
    if (!(axis.z() > kMinCosine) || !(distance > std::abs(place.z()))) continue;
    const double x = place.x() / distance, y = place.y() / distance;
    add({x, y, 0}, -axis.x() / distance);
    add({0, x, y}, -axis.y() / distance);
    // Both are exact for a circle, however long the arc is.
    add({x * x, 2 * x * y, y * y}, 2 * place.z() / place.squaredNorm());
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

// The facets of the same part that are near facet `idx`, which is known.
std::vector<Rigid3> NeighborsOf(std::size_t idx, const std::vector<std::optional<Rigid3>>& facets,
                                const MarkerState& state) {
  constexpr double kReachSides = 4.0;
  const MarkerBlock& marker = state.markers[idx];
  std::vector<Rigid3> neighbors;
  for (std::size_t i = 0; i < facets.size(); ++i) {
    if (i == idx || !facets[i] || state.markers[i].part != marker.part) continue;
    const double distance_m = (facets[i]->translation - facets[idx]->translation).norm();
    if (distance_m < kReachSides * marker.length_m) neighbors.push_back(*facets[i]);
  }
  return neighbors;
}

MarkerChords ChordsOf(const Curvature& curvature, double side_m) {
  constexpr double kMaxShortening = 0.1;
  // Paper may stay flat on a surface that bends less, and the print tolerance is larger than the
  // shortening of such a side, 0.04 %.
  constexpr double kMinBend = 0.1;  // side by radius
  MarkerChords chords;
  for (std::size_t side = 0; side < kNumCorners; ++side) {
    const Eigen::Vector2d along =
        side % 2 == 0 ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY();
    const double squared_bend = curvature.SquaredBend(side_m * along, side_m);
    if (squared_bend < kMinBend * kMinBend) continue;
    chords.side_ratios[side] = 1 - std::min(kMaxShortening, squared_bend / 24);
  }
  if (!chords.IsFlat()) chords.diagonals_difference = curvature.DiagonalsDifference(side_m);
  return chords;
}

double MeanShortening(const MarkerChords& chords) {
  double sum = 0.0;
  for (const double ratio : chords.side_ratios) sum += 1 - ratio;
  return sum / kNumCorners;
}

}  // namespace

std::optional<Rigid3> WorldFromMarker(const MarkerBlock& marker) {
  if (marker.corners.size() != kNumCorners) return std::nullopt;
  std::vector<Eigen::Vector3d> x_in_world;
  for (int i = 0; i < kNumCorners; ++i) x_in_world.push_back(CornerPosition(marker, i));
  if (!HasSpread(x_in_world)) return std::nullopt;
  const auto x_in_marker = CornersInMarker(marker.length_m);
  return EstimateRigid3({x_in_marker.begin(), x_in_marker.end()}, x_in_world);
}

ChordSummary SetChords(MarkerState* state) {
  std::vector<std::optional<Rigid3>> facets;
  for (const MarkerBlock& marker : state->markers) facets.push_back(WorldFromMarker(marker));
  ChordSummary summary;
  for (std::size_t i = 0; i < state->markers.size(); ++i) {
    MarkerBlock& marker = state->markers[i];
    marker.chords = {};
    if (!facets[i] || marker.is_rigid) continue;
    const auto curvature = CurvatureOf(*facets[i], NeighborsOf(i, facets, *state));
    if (!curvature) continue;
    marker.chords = ChordsOf(*curvature, marker.length_m);
    if (marker.chords.IsFlat()) continue;
    summary.curvatures_1_m[marker.marker_id] = curvature->Matrix();
    const double shortening = MeanShortening(marker.chords);
    summary.mean_shortening += shortening / static_cast<double>(state->markers.size());
    if (shortening > summary.largest_shortening) {
      summary.largest_shortening = shortening;
      summary.marker_id = marker.marker_id;
    }
  }
  return summary;
}

}  // namespace velamap
