#include "reconstruct/problem/marker_uncertainty.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "reconstruct/geometry/covariance_update.h"

namespace velamap {
namespace {

// L^-1 e for the global in `column`: its variance is the squared norm, and -factor times it is its
// covariance with the points.
Eigen::VectorXd InverseRoot(const MarkerCovariance& covariance, int column) {
  Eigen::VectorXd unit = Eigen::VectorXd::Unit(covariance.root.rows(), column);
  covariance.root.triangularView<Eigen::Lower>().solveInPlace(unit);
  return unit;
}

// 1 sigma of the global in `column`, with the scale bars as additional measurements.
double GlobalSigma(const MarkerCovariance& covariance, int column, const PointCovariance& points,
                   const Eigen::MatrixXd& bar_gradients, const Eigen::VectorXd& bar_sigmas) {
  const Eigen::VectorXd unit = InverseRoot(covariance, column);
  double variance = unit.squaredNorm();
  if (bar_gradients.cols() > 0) {
    const Eigen::VectorXd with_bars = -bar_gradients.transpose() * (points.factor * unit);
    Eigen::MatrixXd innovation = bar_gradients.transpose() * Multiply(points, bar_gradients);
    innovation.diagonal() += bar_sigmas.cwiseAbs2();
    variance -= with_bars.dot(innovation.llt().solve(with_bars));
  }
  return std::sqrt(std::max(0.0, variance));
}

Eigen::MatrixXd BarGradients(const std::vector<ScaleBar>& bars, const MarkerState& state,
                             Eigen::Index num_rows) {
  Eigen::MatrixXd gradients(num_rows, static_cast<Eigen::Index>(bars.size()));
  for (std::size_t i = 0; i < bars.size(); ++i) {
    gradients.col(static_cast<Eigen::Index>(i)) = BarGradient(bars[i], state);
  }
  return gradients;
}

// From the middle of its marker to each corner; 0 for markers without all corners.
Eigen::VectorXd OffsetsInMarkers(const MarkerState& state, Eigen::Index num_rows) {
  Eigen::VectorXd offsets = Eigen::VectorXd::Zero(num_rows);
  Eigen::Index row = 0;
  for (const MarkerBlock& marker : state.markers) {
    if (marker.corners.size() == kNumCorners) {
      const Eigen::Map<const Eigen::Matrix<double, 3, kNumCorners>> corners(
          marker.x_in_world.data());
      offsets.segment<3 * kNumCorners>(row) =
          (corners.colwise() - corners.rowwise().mean()).reshaped();
    }
    row += marker.NumCoordinates();
  }
  return offsets;
}

// The scale of the print, which scales all points, includes the error due to the inset. Markers
// keep their printed sides whatever the inset is, so the inset only scales the distances between
// them. `share` is its share of the variance assumed for that scale, `sigma` its own sigma.
void HoldSidesAgainstInset(const MarkerState& state, double share, double sigma,
                           const Eigen::VectorXd& inverse_root_of_scale, PointCovariance* points) {
  const Eigen::VectorXd offsets = OffsetsInMarkers(state, points->factor.rows());
  // inset = share * scale + rest, and only the scale is correlated with the points.
  points->factor += share * offsets * inverse_root_of_scale.transpose();
  const Eigen::Index num_columns = points->factor.cols();
  points->factor.conservativeResize(Eigen::NoChange, num_columns + 1);
  points->factor.col(num_columns) = sigma * std::sqrt(std::max(0.0, 1 - share)) * offsets;
  points->signs.setOnes(num_columns + 1);
}

}  // namespace

int GlobalColumn(const MarkerProblem& problem, const double* block) {
  int column = 0;
  for (const double* global : problem.global_blocks) {
    if (global == block) return column;
    column += problem.ceres->ParameterBlockTangentSize(global);
  }
  return -1;
}

std::vector<Eigen::Vector3d> Positions(const MarkerState& state) {
  std::vector<Eigen::Vector3d> positions;
  for (const MarkerBlock& marker : state.markers) {
    for (std::size_t slot = 0; slot < marker.corners.size(); ++slot) {
      positions.emplace_back(CornerPosition(marker, static_cast<int>(slot)));
    }
  }
  return positions;
}

PointCovariance PointsOf(const MarkerState& state, const MarkerCovariance& covariance) {
  PointCovariance points;
  points.blocks = covariance.marker_blocks;
  for (const MarkerBlock& marker : state.markers) {
    for (const int corner : marker.corners) {
      points.point3D_ids.push_back(Point3DIdFromCorner({marker.marker_id, corner}));
    }
  }
  points.factor = covariance.factor;
  points.signs.setOnes(points.factor.cols());
  return points;
}

Eigen::MatrixXd BarCovariance(const std::vector<ScaleBar>& bars, const MarkerState& state,
                              const MarkerProblem& problem, const MarkerCovariance& covariance) {
  const PointCovariance points = PointsOf(state, covariance);
  const Eigen::MatrixXd gradients = BarGradients(bars, state, points.factor.rows());
  Eigen::MatrixXd result = gradients.transpose() * Multiply(points, gradients);
  const int column = GlobalColumn(problem, &state.print_scale);
  if (column < 0) return result;
  const Eigen::VectorXd unit = InverseRoot(covariance, column);
  const Eigen::VectorXd with_scale = gradients.transpose() * (points.factor * unit);
  return result - with_scale * with_scale.transpose() / unit.squaredNorm();
}

Eigen::MatrixXd GlobalCovariance(const MarkerProblem& problem, const MarkerCovariance& covariance,
                                 const double* block) {
  const Eigen::Index size = problem.ceres->ParameterBlockTangentSize(block);
  Eigen::MatrixXd units = Eigen::MatrixXd::Zero(covariance.root.rows(), size);
  units.middleRows(GlobalColumn(problem, block), size).setIdentity();
  covariance.root.triangularView<Eigen::Lower>().solveInPlace(units);
  return units.transpose() * units;
}

double CornerRedundancy(const MarkerJacobian& jacobian, const MarkerCovariance& covariance) {
  // All leverages add up to the number of parameters. The share of the priors is not determined by
  // corners.
  double num_parameters = static_cast<double>(covariance.root.rows() + covariance.factor.rows());
  for (const ResidualJacobian& prior : jacobian.priors) {
    num_parameters -= Leverage(covariance, prior);
  }
  double num_residuals = 0.0;
  for (const ResidualJacobian& view : jacobian.corners) {
    num_residuals += static_cast<double>(view.NumRows());
  }
  return num_residuals - num_parameters;
}

AdjustmentUncertainty MakeUncertainty(const MarkerAdjustmentOptions& options,
                                      const MarkerState& state, const MarkerWeights& weights,
                                      const MarkerProblem& problem,
                                      const MarkerCovariance& covariance) {
  AdjustmentUncertainty uncertainty;
  PointCovariance& points = uncertainty.points;
  points = PointsOf(state, covariance);
  const std::vector<ScaleBar> bars = FindScaleBars(state, weights.scale_bars);
  const Eigen::MatrixXd bar_gradients = BarGradients(bars, state, points.factor.rows());
  Eigen::VectorXd bar_sigmas(bar_gradients.cols());
  for (std::size_t i = 0; i < bars.size(); ++i) {
    bar_sigmas[static_cast<Eigen::Index>(i)] = bars[i].distance.sigma_m;
  }
  const int inset_column = GlobalColumn(problem, &state.inset_px);
  if (inset_column >= 0) {
    uncertainty.apparent_inset_px = state.inset_px;
    uncertainty.apparent_inset_sigma_px =
        GlobalSigma(covariance, inset_column, points, bar_gradients, bar_sigmas);
  }
  uncertainty.rolling_shutter_s = state.rolling_shutter_s;
  const int shutter_column = GlobalColumn(problem, &state.rolling_shutter_s);
  if (shutter_column >= 0) {
    uncertainty.rolling_shutter_sigma_s =
        GlobalSigma(covariance, shutter_column, points, bar_gradients, bar_sigmas);
  }
  const int scale_column = GlobalColumn(problem, &state.print_scale);
  if (scale_column >= 0 && weights.inset_as_scale > 0) {
    const double ratio = weights.inset_as_scale / PrintScaleSigma(options, weights);
    HoldSidesAgainstInset(state, ratio * ratio, weights.inset_as_scale,
                          InverseRoot(covariance, scale_column), &points);
  }
  AddMeasurements(bar_gradients, bar_sigmas, &points);
  const std::vector<Eigen::Vector3d> positions = Positions(state);
  ToInnerConstraints(positions, &points);
  const Eigen::VectorXd by_scale = ScaleGradient(positions);
  uncertainty.relative_scale_sigma =
      std::sqrt(std::max(0.0, by_scale.dot(Multiply(points, by_scale).col(0))));
  return uncertainty;
}

}  // namespace velamap
