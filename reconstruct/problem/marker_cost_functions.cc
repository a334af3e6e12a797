#include "reconstruct/problem/marker_cost_functions.h"

#include <array>
#include <cmath>
#include <utility>

#include <ceres/jet.h>
#include <Eigen/Geometry>

#include "importer/camera/camera_jacobian.h"
#include "importer/camera/camera_projection.h"
#include "importer/geometry/pose_step.h"

namespace velamap {
namespace {

constexpr int kMaxNumIntrinsics = 12;

template <int kCols>
using RowMajor = Eigen::Matrix<double, 2, kCols, Eigen::RowMajor>;

// Derivative of the projection with respect to the camera's parameters.
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

// The parameter blocks of MarkerViewError.
struct ViewParameters {
  explicit ViewParameters(double const* const* parameters)
      : marker(parameters[0]),
        rotation(parameters[1]),
        translation(parameters[1] + 4),
        inset_px(parameters[2][0]),
        intrinsics(parameters[3]),
        rolling_shutter_s(parameters[4][0]),
        rotation_matrix(rotation.toRotationMatrix()) {}

  Eigen::Vector3d InCam(const CornerObservation& corner) const {
    return rotation_matrix * CornerOfBlock(marker, corner.slot) + translation;
  }
  // The term that is added to the projection of a corner to give its residual.
  Eigen::Vector2d OffsetPx(const CornerObservation& corner) const {
    const Eigen::Vector2d offset_px = inset_px * corner.inset_direction - corner.x_in_image_px;
    // Most images are photographs, or come from cameras without a rolling shutter.
    if (rolling_shutter_s == 0) return offset_px;
    return offset_px + Shift(corner).value_px;
  }

  RowShift Shift(const CornerObservation& corner) const {
    return ShiftByRow(corner.motion, rolling_shutter_s);
  }

  const double* marker;
  Eigen::Map<const Eigen::Quaterniond> rotation;
  Eigen::Map<const Eigen::Vector3d> translation;
  double inset_px;
  const double* intrinsics;
  double rolling_shutter_s;
  Eigen::Matrix3d rotation_matrix;
};

using ViewJacobians = std::array<JacobianMap, 5>;

// Sets two rows of the derivatives of one corner's error, in sigmas, with respect to all blocks but
// the intrinsics, from those of its image point with respect to its position in the camera frame.
void SetDerivatives(const ViewParameters& view, const CornerObservation& corner, Eigen::Index row,
                    const Eigen::Matrix<double, 2, 3>& image_by_cam, ViewJacobians* jacobians) {
  const Eigen::Matrix<double, 2, 3> by_cam = image_by_cam / corner.sigma_px;
  auto& [by_marker, by_pose, by_inset, by_intrinsics, by_shutter] = *jacobians;
  if (by_marker.rows() > 0) {
    by_marker.block<2, 3>(row, 3 * corner.slot) = by_cam * view.rotation_matrix;
  }
  if (by_pose.rows() > 0) {
    by_pose.block<2, 4>(row, 0) =
        by_cam * RotatedFromQuaternion(view.rotation, CornerOfBlock(view.marker, corner.slot));
    by_pose.block<2, 3>(row, 4) = by_cam;
  }
  if (by_inset.rows() > 0) by_inset.block<2, 1>(row, 0) = corner.inset_direction / corner.sigma_px;
  if (by_shutter.rows() > 0) {
    by_shutter.block<2, 1>(row, 0) = view.Shift(corner).by_shutter_px_s / corner.sigma_px;
  }
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
                                 std::vector<CornerObservation> corners, double corner_correlation,
                                 double loss_sigmas)
    : camera_model_(camera_model),
      corners_(std::move(corners)),
      whitening_(CornerWhitening::Of(corner_correlation, static_cast<int>(corners_.size()))),
      loss_sigmas_(loss_sigmas) {
  set_num_residuals(2 * static_cast<int>(corners_.size()));
  *mutable_parameter_block_sizes() = {3 * num_corners_in_block, 7, 1, NumCameraParams(camera_model),
                                      1};
}

bool MarkerViewError::Evaluate(double const* const* parameters, double* residuals,
                               double** jacobians) const {
  const ViewParameters view(parameters);
  const auto map = [&](std::size_t i) { return MapJacobian(*this, jacobians, i); };
  ViewJacobians maps = {map(0), map(1), map(2), map(3), map(4)};
  if (maps[0].rows() > 0) maps[0].setZero();
  Eigen::Map<Eigen::VectorXd> in_sigmas(residuals, num_residuals());
  for (Eigen::Index row = 0; row < in_sigmas.size(); row += 2) {
    const CornerObservation& corner = corners_[static_cast<std::size_t>(row / 2)];
    const Eigen::Vector3d x_in_cam = view.InCam(corner);
    if (!(x_in_cam.z() > 0)) return false;
    const Eigen::Vector2d ray = x_in_cam.hnormalized();
    if (jacobians == nullptr) {
      const Eigen::Vector2d projected =
          ImageFromRay<double, double>(camera_model_, view.intrinsics, ray);
      in_sigmas.segment<2>(row) = (projected + view.OffsetPx(corner)) / corner.sigma_px;
      continue;
    }
    const RayFunction projection = ImageFromRayWithJacobian(camera_model_, view.intrinsics, ray);
    in_sigmas.segment<2>(row) = (projection.value + view.OffsetPx(corner)) / corner.sigma_px;
    SetDerivatives(view, corner, row, projection.by_ray * RayByPoint(x_in_cam), &maps);
    if (maps[3].rows() > 0) {
      maps[3].middleRows<2>(row) =
          ProjectionByIntrinsics(camera_model_, view.intrinsics, ray).leftCols(maps[3].cols()) /
          corner.sigma_px;
    }
  }
  Whiten(whitening_, in_sigmas);
  for (JacobianMap& derivatives : maps) {
    if (derivatives.rows() > 0) Whiten(whitening_, derivatives);
  }
  if (std::isinf(loss_sigmas_)) return true;
  for (Eigen::Index row = 0; row < in_sigmas.size(); row += 2) {
    Eigen::Matrix2d by_whitened;
    in_sigmas.segment<2>(row) =
        RobustResidual(in_sigmas.segment<2>(row), loss_sigmas_, &by_whitened);
    for (JacobianMap& derivatives : maps) {
      if (derivatives.rows() > 0)
        derivatives.middleRows<2>(row) = by_whitened * derivatives.middleRows<2>(row);
    }
  }
  return true;
}

}  // namespace velamap
