#include "reconstruct/problem/prior_cost_functions.h"

#include <array>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/base/ids.h"
#include "reconstruct/problem/marker_cost_functions.h"

namespace velamap {
namespace {

// Residual of the difference of the diagonals. Its derivative goes to a row of `jacobian`, unless
// that is empty.
double EvaluateDiagonals(const double* marker, double sigma_m, int row, JacobianMap* jacobian) {
  const Eigen::Vector3d diagonal1 = CornerOfBlock(marker, 2) - CornerOfBlock(marker, 0);
  const Eigen::Vector3d diagonal2 = CornerOfBlock(marker, 3) - CornerOfBlock(marker, 1);
  if (jacobian->rows() > 0) {
    const Eigen::RowVector3d direction1 = diagonal1.normalized().transpose() / sigma_m;
    const Eigen::RowVector3d direction2 = diagonal2.normalized().transpose() / sigma_m;
    jacobian->row(row) << -direction1, direction2, direction1, -direction2;
  }
  return (diagonal1.norm() - diagonal2.norm()) / sigma_m;
}

// The same for the distance of the corners from their plane. The signed distances from the best
// plane are h, -h, h, -h.
double EvaluateFlatness(const double* marker, double sigma_m, int row, JacobianMap* jacobian) {
  const Eigen::Vector3d diagonal1 = CornerOfBlock(marker, 2) - CornerOfBlock(marker, 0);
  const Eigen::Vector3d diagonal2 = CornerOfBlock(marker, 3) - CornerOfBlock(marker, 1);
  const Eigen::Vector3d alternating = CornerOfBlock(marker, 0) - CornerOfBlock(marker, 1) +
                                      CornerOfBlock(marker, 2) - CornerOfBlock(marker, 3);
  const Eigen::Vector3d cross = diagonal1.cross(diagonal2);
  const Eigen::Vector3d normal = cross.normalized();
  const double factor = 0.25 / sigma_m;
  if (jacobian->rows() > 0) {
    const Eigen::Vector3d by_cross =
        factor * (alternating - alternating.dot(normal) * normal) / cross.norm();
    const Eigen::Vector3d by_diagonal1 = diagonal2.cross(by_cross);
    const Eigen::Vector3d by_diagonal2 = by_cross.cross(diagonal1);
    jacobian->block<1, 3>(row, 0) = factor * normal - by_diagonal1;
    jacobian->block<1, 3>(row, 3) = -factor * normal - by_diagonal2;
    jacobian->block<1, 3>(row, 6) = factor * normal + by_diagonal1;
    jacobian->block<1, 3>(row, 9) = -factor * normal + by_diagonal2;
  }
  return factor * alternating.dot(normal);
}

}  // namespace

std::vector<std::pair<int, int>> MarkerPriorError::Sides(const std::vector<int>& corners) {
  std::vector<std::pair<int, int>> sides;
  const int count = static_cast<int>(corners.size());
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      if (corners[j] == corners[i] % kNumCorners + 1) sides.emplace_back(i, j);
    }
  }
  return sides;
}

MarkerPriorError::MarkerPriorError(const MarkerPrior& prior, const std::vector<int>& corners)
    : prior_(prior) {
  if (prior.side_sigma_m > 0) sides_ = Sides(corners);
  for (const auto& side : sides_) {
    const int corner = corners[static_cast<std::size_t>(side.first)];
    chords_m_.push_back(prior.length_m *
                        prior.chords.side_ratios[static_cast<std::size_t>(corner - 1)]);
  }
  const bool is_whole = corners.size() == kNumCorners;
  has_diagonals_ = is_whole && prior.diagonals_sigma_m > 0;
  has_flatness_ = is_whole && prior.flatness_sigma_m > 0;
  set_num_residuals(static_cast<int>(sides_.size()) + (has_diagonals_ ? 1 : 0) +
                    (has_flatness_ ? 1 : 0));
  *mutable_parameter_block_sizes() = {3 * static_cast<int>(corners.size()), 1, 1};
}

bool MarkerPriorError::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
  const int num_sides = static_cast<int>(sides_.size());
  JacobianMap by_marker = MapJacobian(*this, jacobians, 0);
  std::array<JacobianMap, 2> by_scales = {MapJacobian(*this, jacobians, 1),
                                          MapJacobian(*this, jacobians, 2)};
  const double scale = 1.0 + parameters[1][0] + parameters[2][0];
  by_marker.setZero();
  for (int i = 0; i < num_sides; ++i) {
    const auto [a, b] = sides_[i];
    const Eigen::Vector3d side = CornerOfBlock(parameters[0], b) - CornerOfBlock(parameters[0], a);
    const double length_m = side.norm();
    residuals[i] = length_m / prior_.side_sigma_m;
    if (by_marker.rows() > 0) {
      const Eigen::RowVector3d direction = side.transpose() / (length_m * prior_.side_sigma_m);
      by_marker.block<1, 3>(i, 3 * a) = -direction;
      by_marker.block<1, 3>(i, 3 * b) = direction;
    }
  }
  if (has_diagonals_) {
    residuals[num_sides] =
        EvaluateDiagonals(parameters[0], prior_.diagonals_sigma_m, num_sides, &by_marker);
  }
  if (has_flatness_) {
    const int row = num_residuals() - 1;
    residuals[row] = EvaluateFlatness(parameters[0], prior_.flatness_sigma_m, row, &by_marker);
  }
  Eigen::Map<Eigen::VectorXd> all(residuals, num_residuals());
  all /= scale;
  by_marker /= scale;
  for (JacobianMap& by_scale : by_scales) {
    if (by_scale.rows() > 0) by_scale = -all / scale;
  }
  for (int i = 0; i < num_sides; ++i) {
    residuals[i] -= chords_m_[static_cast<std::size_t>(i)] / prior_.side_sigma_m;
  }
  if (has_diagonals_) {
    residuals[num_sides] -=
        prior_.chords.diagonals_difference * prior_.length_m / prior_.diagonals_sigma_m;
  }
  return true;
}

ScaleBarError::ScaleBarError(double length_m, double sigma_m,
                             std::vector<std::vector<double>> corner_weights)
    : length_m_(length_m), sigma_m_(sigma_m), corner_weights_(std::move(corner_weights)) {
  set_num_residuals(1);
  for (const std::vector<double>& weights : corner_weights_) {
    mutable_parameter_block_sizes()->push_back(3 * static_cast<int>(weights.size()));
  }
}

bool ScaleBarError::Evaluate(double const* const* parameters, double* residuals,
                             double** jacobians) const {
  Eigen::Vector3d bar = Eigen::Vector3d::Zero();
  for (std::size_t block = 0; block < corner_weights_.size(); ++block) {
    for (std::size_t i = 0; i < corner_weights_[block].size(); ++i) {
      bar +=
          corner_weights_[block][i] * Eigen::Map<const Eigen::Vector3d>(parameters[block] + 3 * i);
    }
  }
  residuals[0] = (bar.norm() - length_m_) / sigma_m_;
  const Eigen::Vector3d direction = bar.normalized() / sigma_m_;
  for (std::size_t block = 0; jacobians != nullptr && block < corner_weights_.size(); ++block) {
    for (std::size_t i = 0; jacobians[block] != nullptr && i < corner_weights_[block].size(); ++i) {
      Eigen::Map<Eigen::Vector3d>(jacobians[block] + 3 * i) = corner_weights_[block][i] * direction;
    }
  }
  return true;
}

ParameterPriorError::ParameterPriorError(std::vector<double> mean, std::vector<double> sigma)
    : mean_(std::move(mean)), sigma_(std::move(sigma)) {
  VELAMAP_CHECK(mean_.size() == sigma_.size());
  set_num_residuals(static_cast<int>(mean_.size()));
  *mutable_parameter_block_sizes() = {static_cast<int>(mean_.size())};
}

bool ParameterPriorError::Evaluate(double const* const* parameters, double* residuals,
                                   double** jacobians) const {
  const int count = num_residuals();
  for (int i = 0; i < count; ++i) residuals[i] = (parameters[0][i] - mean_[i]) / sigma_[i];
  JacobianMap by_params = MapJacobian(*this, jacobians, 0);
  by_params.setZero();
  for (int i = 0; i < by_params.rows(); ++i) by_params(i, i) = 1.0 / sigma_[i];
  return true;
}

PixelShapeError::PixelShapeError(int num_params, double sigma) : sigma_(sigma) {
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {num_params};
}

bool PixelShapeError::Evaluate(double const* const* parameters, double* residuals,
                               double** jacobians) const {
  const double fx = parameters[0][0], fy = parameters[0][1];
  if (!(fx > 0 && fy > 0)) return false;
  residuals[0] = std::log(fx / fy) / sigma_;
  JacobianMap by_params = MapJacobian(*this, jacobians, 0);
  if (by_params.rows() == 0) return true;
  by_params.setZero();
  by_params(0, 0) = 1.0 / (fx * sigma_);
  by_params(0, 1) = -1.0 / (fy * sigma_);
  return true;
}

}  // namespace velamap
