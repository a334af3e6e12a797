#include "reconstruct/sizes/bend_evidence.h"

#include <array>
#include <cmath>
#include <limits>

#include "reconstruct/geometry/marker_pose.h"

namespace velamap {
namespace {

// The sides and diagonals of a marker, by its corners.
constexpr std::array<std::array<int, 2>, 6> kLines = {
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}, {1, 3}}};
using ByLine = Eigen::Matrix<double, kLines.size(), 1>;

// How much shorter than printed the lines are on a surface, as fractions, relative to their mean.
ByLine RelativeShortenings(double length_m, const Eigen::Matrix2d& curvature_1_m) {
  const auto corners = CornersInMarker(length_m);
  ByLine shortenings;
  for (std::size_t i = 0; i < kLines.size(); ++i) {
    const auto [a, b] = kLines[i];
    const Eigen::Vector2d line_m =
        (corners[static_cast<std::size_t>(b)] - corners[static_cast<std::size_t>(a)]).head<2>();
    const double bend = line_m.dot(curvature_1_m * line_m) / line_m.norm();
    shortenings[static_cast<Eigen::Index>(i)] = bend * bend / 24;
  }
  return shortenings.array() - shortenings.mean();
}

}  // namespace

BendEvidence FindBendEvidence(const MarkerState& state, const MarkerCovariance& covariance,
                              const std::map<int, Eigen::Matrix2d>& curvatures_1_m,
                              const MarkerAdjustmentOptions& options) {
  // The effect, by line, of a print that is as much too wide as it is too low.
  const ByLine aspect = (ByLine() << 0.5, -0.5, 0.5, -0.5, 0, 0).finished();
  double squares = 0.0, products = 0.0, by_aspect = 0.0, block_variance = 0.0;
  Eigen::VectorXd by_factor = Eigen::VectorXd::Zero(covariance.factor.cols());
  for (std::size_t i = 0; i < state.markers.size(); ++i) {
    const MarkerBlock& marker = state.markers[i];
    const auto curvature = curvatures_1_m.find(marker.marker_id);
    if (curvature == curvatures_1_m.end()) continue;
    const ByLine weights = RelativeShortenings(marker.length_m, curvature->second);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(marker.NumCoordinates());
    for (std::size_t k = 0; k < kLines.size(); ++k) {
      const auto [a, b] = kLines[k];
      const Eigen::Vector3d line_m = CornerPosition(marker, b) - CornerPosition(marker, a);
      const double printed_m = k < kNumCorners ? marker.length_m : std::sqrt(2) * marker.length_m;
      const double weight = weights[static_cast<Eigen::Index>(k)];
      products -= weight * line_m.norm() / printed_m;
      gradient.segment<3>(3 * a) += weight / printed_m * line_m.normalized();
      gradient.segment<3>(3 * b) -= weight / printed_m * line_m.normalized();
    }
    squares += weights.squaredNorm();
    by_aspect += weights.dot(aspect);
    block_variance += gradient.dot(covariance.marker_blocks[i] * gradient);
    by_factor += covariance.FactorOf(i).transpose() * gradient;
  }
  if (!(squares > 0)) return {0.0, std::numeric_limits<double>::infinity()};
  const double variance = block_variance + by_factor.squaredNorm() +
                          std::pow(options.print_tolerance, 2) * squares +
                          std::pow(options.common_print_tolerance * by_aspect, 2);
  return {products / squares, std::sqrt(variance) / squares};
}

}  // namespace velamap
