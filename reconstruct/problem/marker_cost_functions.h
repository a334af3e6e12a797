// Cost function of the corners of one marker in one image, in the marker-aware bundle adjustment;
// prior_cost_functions.h has what is known beforehand. Residuals are divided by their sigmas;
// derivatives are analytic.
//
// Parameter blocks
// clang-format off
//   marker       3 x c  the c <= 4 corners of a marker that are in the model, world frame, m
//   pose         7      cam_from_world while the middle row is read: quaternion x y z w, then m
//   inset        1      apparent inset of all corners, px
//   intrinsics   3..12  parameters of one camera, in COLMAP's order
//   shutter      1      readout time, from the first row of an image to the last, s
//   print scale  1      scale of all printed sides, minus 1
//   part scale   1      the same for the sides on one part of the layout, in addition
// clang-format on

#pragma once

#include <cstddef>
#include <vector>

#include <ceres/cost_function.h>
#include <Eigen/Core>

#include "importer/camera/camera.h"
#include "reconstruct/problem/corner_whitening.h"
#include "reconstruct/problem/rolling_shutter.h"

namespace velamap {

// One corner of a marker in one image.
struct CornerObservation {
  int slot = 0;  // index among the corners of the marker block
  Eigen::Vector2d x_in_image_px = Eigen::Vector2d::Zero();
  double sigma_px = 1.0;  // of each coordinate
  // The movement of the corner by an apparent inset of one px: the sum of the unit vectors in the
  // image that point from the corner along its two sides. The sides of a square seen straight on
  // shrink by twice the inset. Zero if a neighbouring corner is unknown.
  Eigen::Vector2d inset_direction = Eigen::Vector2d::Zero();
  RowMotion motion;
};

// The corner in a slot of a marker block.
inline Eigen::Map<const Eigen::Vector3d> CornerOfBlock(const double* marker, int slot) {
  return Eigen::Map<const Eigen::Vector3d>(marker + 3 * slot);
}

using JacobianMap =
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

// Where Evaluate() of `error` puts the derivatives by one parameter block. `jacobians` is what
// Ceres passes; the map has no rows if Ceres does not ask for these derivatives.
inline JacobianMap MapJacobian(const ceres::CostFunction& error, double** jacobians,
                               std::size_t block_idx) {
  double* data = jacobians == nullptr ? nullptr : jacobians[block_idx];
  return JacobianMap(data, data == nullptr ? 0 : error.num_residuals(),
                     error.parameter_block_sizes()[block_idx]);
}

// Applies the Cauchy loss to a whitened residual r itself, so that one residual block can hold
// several corners with a loss each: r becomes g r with |g r|^2 = a^2 log(1 + |r|^2 / a^2) and a =
// loss_sigmas. Infinite loss_sigmas: no loss. `jacobian` is the derivative of the result with
// respect to r and may be null.
Eigen::Vector2d RobustResidual(const Eigen::Vector2d& whitened, double loss_sigmas,
                               Eigen::Matrix2d* jacobian);

// Projection + inset + motion while rows are read - observation of all corners of one marker in one
// image, in sigmas and whitened: two residuals for each corner. Blocks: marker, pose, inset,
// intrinsics, shutter. Evaluation fails for a corner that is not in front of the camera.
class MarkerViewError : public ceres::CostFunction {
 public:
  MarkerViewError(CameraModel camera_model, int num_corners_in_block,
                  std::vector<CornerObservation> corners, double corner_correlation,
                  double loss_sigmas);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  CameraModel camera_model_;
  std::vector<CornerObservation> corners_;
  CornerWhitening whitening_;
  double loss_sigmas_;
};

}  // namespace velamap
