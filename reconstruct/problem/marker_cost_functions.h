// Cost functions of the marker-aware bundle adjustment. Residuals are divided by their sigmas;
// derivatives are analytic.
//
// Parameter blocks
// clang-format off
//   marker       3 x c  the c <= 4 corners of a marker that are in the model, world frame, m
//   pose         7      cam_from_world while the middle row is read: quaternion x y z w, then m
//   inset        1      apparent inset of all corners, px
//   intrinsics   3..12  parameters of one camera, in COLMAP's order
//   shutter      1      time from the first row of an image to the last, s
//   print scale  1      scale of all printed sides, less 1
//   part scale   1      the same for the sides on one part of the layout, in addition
// clang-format on

#pragma once

#include <utility>
#include <vector>

#include <ceres/cost_function.h>
#include <Eigen/Core>

#include "importer/camera/camera.h"

namespace velamap {

// One corner of a marker in one image.
struct CornerObservation {
  int slot = 0;  // index among the corners of the marker block
  Eigen::Vector2d x_in_image_px = Eigen::Vector2d::Zero();
  double sigma_px = 1.0;  // of each coordinate
  // The movement of the corner by an apparent inset of one px: the sum of the unit vectors in the
  // image that point from the corner along its two sides. The sides of a square seen straight on
  // shrink by twice the inset. Zero where a neighbouring corner is unknown.
  Eigen::Vector2d inset_direction = Eigen::Vector2d::Zero();
  // The movement of the corner from when the middle row is read to when its own is, by one second
  // from the first row to the last.
  Eigen::Vector2d shutter_direction_px_s = Eigen::Vector2d::Zero();
};

// Applies the Cauchy loss to a whitened residual r itself, so that one residual block can hold
// several corners with a loss each: r becomes g r with |g r|^2 = a^2 log(1 + |r|^2 / a^2) and
// a = loss_sigmas. Infinite loss_sigmas: no loss. `jacobian` is the derivative of the result by r
// and may be null.
Eigen::Vector2d RobustResidual(const Eigen::Vector2d& whitened, double loss_sigmas,
                               Eigen::Matrix2d* jacobian);

// Projection + inset + motion while rows are read - observation of all corners of one marker in one
// image, two residuals for each corner. Blocks: marker, pose, inset, intrinsics, shutter.
// Evaluation fails for a corner that is not in front of the camera.
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

// Prior of the shape of a printed marker. A sigma that is not positive switches its part off.
struct MarkerPrior {
  double length_m = 0.0;           // of a side
  double side_sigma_m = 0.0;       // of a side
  double diagonals_sigma_m = 0.0;  // of the difference of the diagonals
  double flatness_sigma_m = 0.0;   // of a corner's distance from the plane of the marker
};

// Residuals of a marker against its prior: sides between neighbouring corners less
// (1 + print scale + part scale) * length; for a marker with four corners also the difference of
// the diagonals, and the distance of the corners from their plane, which is in front and behind in
// turns. Without the diagonals a square could become a rhombus, which a single view cannot tell
// from a tilted square. `corners` are 1..4, ascending. Blocks: marker, print scale, part scale.
class MarkerPriorError : public ceres::CostFunction {
 public:
  MarkerPriorError(const MarkerPrior& prior, const std::vector<int>& corners);

  // Pairs of slots of neighbouring corners.
  static std::vector<std::pair<int, int>> Sides(const std::vector<int>& corners);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  MarkerPrior prior_;
  std::vector<std::pair<int, int>> sides_;
  bool has_diagonals_ = false;
  bool has_flatness_ = false;
};

// Known distance between two points, each of which is a corner or the mean of a marker's corners:
// (|sum of weight * corner| - length) / sigma. There is one block for each marker, with the weights
// of its corners; those of the first point are negative.
class ScaleBarError : public ceres::CostFunction {
 public:
  ScaleBarError(double length_m, double sigma_m, std::vector<std::vector<double>> corner_weights);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  double length_m_, sigma_m_;
  std::vector<std::vector<double>> corner_weights_;
};

// (parameter - mean) / sigma for each parameter of one block. An infinite sigma adds nothing.
class ParameterPriorError : public ceres::CostFunction {
 public:
  ParameterPriorError(std::vector<double> mean, std::vector<double> sigma);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  std::vector<double> mean_, sigma_;
};

// log(fx / fy) / sigma of a camera with two focal lengths, which come first of its `num_params`.
class PixelShapeError : public ceres::CostFunction {
 public:
  PixelShapeError(int num_params, double sigma);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  int num_params_;
  double sigma_;
};

}  // namespace velamap
