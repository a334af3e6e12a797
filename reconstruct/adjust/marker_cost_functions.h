// Residuals of the marker-aware bundle adjustment, whitened by their sigmas, with analytic
// derivatives. Private to this room: it shows Ceres.
//
// Parameter blocks
//   marker      3 x c    its c <= 4 corners that are in the model, world frame, m
//   pose        7        cam_from_world at the middle row: quaternion x y z w, translation (m)
//   inset       1        apparent inset of all corners, px
//   intrinsics  3..12    of one camera, in COLMAP's order
//   velocity    6        of the cam frame in one image: linear (m/s), angular (rad/s)
//   print scale 1        of all printed sides, as a fraction beyond 0

#pragma once

#include <utility>
#include <vector>

#include <ceres/cost_function.h>
#include <Eigen/Core>

#include "importer/camera/camera.h"

namespace velamap {

// One corner of a marker in one image.
struct CornerObservation {
  int slot = 0;  // place in the marker block
  Eigen::Vector2d x_in_image_px = Eigen::Vector2d::Zero();
  double sigma_px = 1.0;  // of each coordinate
  // Where an apparent inset of one px moves the corner: the sum of the unit vectors, in the image,
  // along its two sides, away from the corner. A square seen straight on gets smaller by twice the
  // inset. Zero where the neighbours are unknown.
  Eigen::Vector2d inset_direction = Eigen::Vector2d::Zero();
  double row_time_s = 0.0;  // of its image row after the middle row
};

// Cauchy's loss on the length of a whitened residual r, folded into the residual so that one
// residual block can hold several corners: r becomes g r with |g r|^2 = a^2 log(1 + |r|^2 / a^2),
// a = loss_sigmas. Infinite: no loss. `jacobian` of the result by r, may be null.
Eigen::Vector2d RobustResidual(const Eigen::Vector2d& whitened, double loss_sigmas,
                               Eigen::Matrix2d* jacobian);

// All corners of one marker in one image: projection + inset - observation, two residuals a corner.
// Blocks: marker, pose, inset, intrinsics, velocity. While rows are read the camera moves evenly,
//   x_in_cam(row) = x + row_time (linear + angular x x),   x = cam_from_world * x_in_world,
// to first order. Fails to evaluate for a corner that is not in front of the camera.
class MarkerViewError : public ceres::CostFunction {
 public:
  MarkerViewError(CameraModel camera_model, int num_corners_in_block,
                  std::vector<CornerObservation> corners, double loss_sigmas);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  CameraModel camera_model_;
  std::vector<CornerObservation> corners_;
  double loss_sigmas_;
};

// What is known of a printed marker; sigmas that are not positive mean: not known.
struct MarkerPrior {
  double length_m = 0.0;
  double side_sigma_m = 0.0;
  double diagonals_sigma_m = 0.0;  // of their difference
  double flatness_sigma_m = 0.0;
};

// Sides between neighbouring corners against (1 + print scale) * length, each with side_sigma_m,
// and, for four corners, the difference of the diagonals (without it a square could become a
// rhombus, which a single view does not tell from a tilt) with diagonals_sigma_m, and the corners'
// distance from their plane, alternately in front and behind, with flatness_sigma_m. `corners`
// are 1..4, ascending. Blocks: marker, print scale.
class MarkerPriorError : public ceres::CostFunction {
 public:
  MarkerPriorError(const MarkerPrior& prior, const std::vector<int>& corners);

  // Slots of neighbouring corners that are both there.
  static std::vector<std::pair<int, int>> Sides(const std::vector<int>& corners);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  MarkerPrior prior_;
  std::vector<std::pair<int, int>> sides_;
  bool has_diagonals_ = false;
  bool has_flatness_ = false;
};

// A distance between two points, each a corner or the mean of a marker's corners, as
// (|sum of weight * corner| - length) / sigma. One block a marker, with the weights of its corners;
// those of the first point are negative.
class ScaleBarError : public ceres::CostFunction {
 public:
  ScaleBarError(double length_m, double sigma_m, std::vector<std::vector<double>> corner_weights);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  double length_m_, sigma_m_;
  std::vector<std::vector<double>> corner_weights_;
};

// (parameter - mean) / sigma for each parameter of one block; infinite sigmas add nothing.
class ParameterPriorError : public ceres::CostFunction {
 public:
  ParameterPriorError(std::vector<double> mean, std::vector<double> sigma);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  std::vector<double> mean_, sigma_;
};

}  // namespace velamap
