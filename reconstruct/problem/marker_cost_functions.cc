#include "reconstruct/problem/marker_cost_functions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <ceres/jet.h>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/base/ids.h"
#include "importer/camera/camera_jacobian.h"
#include "importer/camera/camera_projection.h"
#include "importer/geometry/pose_step.h"

namespace velamap {
namespace {

constexpr int kMaxNumIntrinsics = 12;

template <int kCols>
using RowMajor = Eigen::Matrix<double, 2, kCols, Eigen::RowMajor>;
using JacobianMap =
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

// Derivative of the projection by the camera's parameters.
RowMajor<kMaxNumIntrinsics> ProjectionByIntrinsics(CameraModel model, const double* intrinsics,
                                                   const Eigen::Vector2d& ray) {
  using Jet = ceres::Jet<double, kMaxNumIntrinsics>;
  std::array<Jet, kMaxNumIntrinsics> params;
  for (int i = 0; i < NumCameraParams(model); ++i) params[i] = Jet(intrinsics[i], i);
  const Eigen::Matrix<Jet, 2, 1> x =
      ImageFromRay<Jet, Jet>(model, params.data(), {Jet(ray.x()), Jet(ray.y())});
  RowMajor<kMaxNumIntrinsics> jacobian;
  jacobian.row(0) = x[0].v;
  jacobian.row(1) = x[1].v;
  return jacobian;
}

Eigen::Map<const Eigen::Vector3d> Corner(const double* marker, int slot) {
  return Eigen::Map<const Eigen::Vector3d>(marker + 3 * slot);
}

// Residual of the difference of the diagonals. Its derivative goes to a row of `jacobian`, unless
// that is empty.
double EvaluateDiagonals(const double* marker, double sigma_m, int row, JacobianMap* jacobian) {
  const Eigen::Vector3d diagonal1 = Corner(marker, 2) - Corner(marker, 0);
  const Eigen::Vector3d diagonal2 = Corner(marker, 3) - Corner(marker, 1);
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
  const Eigen::Vector3d diagonal1 = Corner(marker, 2) - Corner(marker, 0);
  const Eigen::Vector3d diagonal2 = Corner(marker, 3) - Corner(marker, 1);
  const Eigen::Vector3d alternating =
      Corner(marker, 0) - Corner(marker, 1) + Corner(marker, 2) - Corner(marker, 3);
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

Eigen::Vector2d RobustResidual(const Eigen::Vector2d& whitened, double loss_sigmas,
                               Eigen::Matrix2d* jacobian) {
  if (jacobian != nullptr) jacobian->setIdentity();
  if (std::isinf(loss_sigmas)) return whitened;
  // With q = |r|^2 / a^2: g = sqrt(log(1 + q) / q).
  const double q = whitened.squaredNorm() / (loss_sigmas * loss_sigmas);
  const bool is_small = q < 1e-5;
  const double squared_g = is_small ? 1.0 - 0.5 * q : std::log1p(q) / q;
  const double g = std::sqrt(squared_g);
  if (jacobian != nullptr) {
    const double dsquared_g = is_small ? -0.5 + 2.0 / 3.0 * q : (1.0 / (1.0 + q) - squared_g) / q;
    *jacobian = g * Eigen::Matrix2d::Identity() +
                dsquared_g / (g * loss_sigmas * loss_sigmas) * whitened * whitened.transpose();
  }
  return g * whitened;
}

MarkerViewError::MarkerViewError(CameraModel camera_model, int num_corners_in_block,
                                 std::vector<CornerObservation> corners, double loss_sigmas)
    : camera_model_(camera_model), corners_(std::move(corners)), loss_sigmas_(loss_sigmas) {
  set_num_residuals(2 * static_cast<int>(corners_.size()));
  *mutable_parameter_block_sizes() = {3 * num_corners_in_block, 7, 1, NumCameraParams(camera_model),
                                      1};
}

bool MarkerViewError::Evaluate(double const* const* parameters, double* residuals,
                               double** jacobians) const {
  const Eigen::Map<const Eigen::Quaterniond> rotation(parameters[1]);
  const Eigen::Map<const Eigen::Vector3d> translation(parameters[1] + 4);
  const double inset_px = parameters[2][0];
  const double* intrinsics = parameters[3];
  const double rolling_shutter_s = parameters[4][0];
  const Eigen::Matrix3d rotation_matrix = rotation.toRotationMatrix();

  const auto map = [&](std::size_t i) {
    double* data = jacobians == nullptr ? nullptr : jacobians[i];
    return JacobianMap(data, data == nullptr ? 0 : num_residuals(), parameter_block_sizes()[i]);
  };
  std::array<JacobianMap, 5> maps = {map(0), map(1), map(2), map(3), map(4)};
  if (maps[0].rows() > 0) maps[0].setZero();
  const int num_corners = static_cast<int>(corners_.size());
  for (int i = 0; i < num_corners; ++i) {
    const CornerObservation& corner = corners_[i];
    const Eigen::Map<const Eigen::Vector3d> x_in_world(parameters[0] + 3 * corner.slot);
    const Eigen::Vector3d x_in_cam = rotation_matrix * x_in_world + translation;
    if (!(x_in_cam.z() > 0)) return false;
    const Eigen::Vector2d ray = x_in_cam.hnormalized();
    const Eigen::Vector2d offset_px = inset_px * corner.inset_direction +
                                      rolling_shutter_s * corner.shutter_direction_px_s -
                                      corner.x_in_image_px;
    if (jacobians == nullptr) {
      const Eigen::Vector2d projected =
          ImageFromRay<double, double>(camera_model_, intrinsics, ray);
      Eigen::Map<Eigen::Vector2d>(residuals + 2 * i) =
          RobustResidual((projected + offset_px) / corner.sigma_px, loss_sigmas_, nullptr);
      continue;
    }
    const RayFunction projection = ImageFromRayWithJacobian(camera_model_, intrinsics, ray);
    const Eigen::Vector2d error_px = projection.value + offset_px;
    Eigen::Matrix2d by_whitened;
    Eigen::Map<Eigen::Vector2d>(residuals + 2 * i) =
        RobustResidual(error_px / corner.sigma_px, loss_sigmas_, &by_whitened);

    const Eigen::Matrix2d by_image = by_whitened / corner.sigma_px;
    Eigen::Matrix<double, 2, 3> ray_by_cam;
    ray_by_cam << 1, 0, -ray.x(), 0, 1, -ray.y();
    const Eigen::Matrix<double, 2, 3> by_cam =
        by_image * projection.by_ray * ray_by_cam / x_in_cam.z();
    if (maps[0].rows() > 0) {
      maps[0].block<2, 3>(2 * i, 3 * corner.slot) = by_cam * rotation_matrix;
    }
    if (maps[1].rows() > 0) {
      maps[1].block<2, 4>(2 * i, 0) = by_cam * RotatedFromQuaternion(rotation, x_in_world);
      maps[1].block<2, 3>(2 * i, 4) = by_cam;
    }
    if (maps[2].rows() > 0) maps[2].block<2, 1>(2 * i, 0) = by_image * corner.inset_direction;
    if (maps[3].rows() > 0) {
      maps[3].middleRows<2>(2 * i) =
          by_image *
          ProjectionByIntrinsics(camera_model_, intrinsics, ray).leftCols(maps[3].cols());
    }
    if (maps[4].rows() > 0) {
      maps[4].block<2, 1>(2 * i, 0) = by_image * corner.shutter_direction_px_s;
    }
  }
  return true;
}

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
  double* by_marker = jacobians == nullptr ? nullptr : jacobians[0];
  const std::array<double*, 2> by_scales = {jacobians == nullptr ? nullptr : jacobians[1],
                                            jacobians == nullptr ? nullptr : jacobians[2]};
  const double scale = 1.0 + parameters[1][0] + parameters[2][0];
  JacobianMap marker_map(by_marker, by_marker == nullptr ? 0 : num_residuals(),
                         parameter_block_sizes()[0]);
  marker_map.setZero();
  for (double* by_scale : by_scales) {
    if (by_scale != nullptr) std::fill(by_scale, by_scale + num_residuals(), 0.0);
  }
  for (int i = 0; i < num_sides; ++i) {
    const auto [a, b] = sides_[i];
    const Eigen::Vector3d side = Corner(parameters[0], b) - Corner(parameters[0], a);
    const double length_m = side.norm();
    residuals[i] = (length_m - scale * prior_.length_m) / prior_.side_sigma_m;
    if (by_marker != nullptr) {
      const Eigen::RowVector3d direction = side.transpose() / (length_m * prior_.side_sigma_m);
      marker_map.block<1, 3>(i, 3 * a) = -direction;
      marker_map.block<1, 3>(i, 3 * b) = direction;
    }
    for (double* by_scale : by_scales) {
      if (by_scale != nullptr) by_scale[i] = -prior_.length_m / prior_.side_sigma_m;
    }
  }
  if (has_diagonals_) {
    residuals[num_sides] =
        EvaluateDiagonals(parameters[0], prior_.diagonals_sigma_m, num_sides, &marker_map);
  }
  if (has_flatness_) {
    const int row = num_residuals() - 1;
    residuals[row] = EvaluateFlatness(parameters[0], prior_.flatness_sigma_m, row, &marker_map);
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
  if (jacobians == nullptr || jacobians[0] == nullptr) return true;
  JacobianMap map(jacobians[0], count, count);
  map.setZero();
  for (int i = 0; i < count; ++i) map(i, i) = 1.0 / sigma_[i];
  return true;
}

PixelShapeError::PixelShapeError(int num_params, double sigma)
    : num_params_(num_params), sigma_(sigma) {
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {num_params};
}

bool PixelShapeError::Evaluate(double const* const* parameters, double* residuals,
                               double** jacobians) const {
  const double fx = parameters[0][0], fy = parameters[0][1];
  if (!(fx > 0 && fy > 0)) return false;
  residuals[0] = std::log(fx / fy) / sigma_;
  if (jacobians == nullptr || jacobians[0] == nullptr) return true;
  std::fill_n(jacobians[0], num_params_, 0.0);
  jacobians[0][0] = 1.0 / (fx * sigma_);
  jacobians[0][1] = -1.0 / (fy * sigma_);
  return true;
}

}  // namespace velamap
