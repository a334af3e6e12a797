// How the motion of a picture changes from place to place.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace velamap {

// Velocity, px/s, then acceleration, px/s^2, then jerk, px/s^3.
using MotionVector = Eigen::Matrix<double, 6, 1>;

struct PlacedMotion {
  Eigen::Vector2d x_in_image_px;
  MotionVector motion;
  double weight = 1.0;
};

// A quadratic polynomial of the place. A camera that turns moves the picture of whatever it sees
// with velocities that are quadratic in x and y (Longuet-Higgins and Prazdny, "The interpretation
// of a moving retinal image", 1980); an affine field would change the size of each marker according
// to its place.
class MotionField {
 public:
  static constexpr int kNumTerms = 5;  // without the constant
  using Terms = Eigen::Matrix<double, 1, kNumTerms>;

  // Fits the motions, by least squares, of markers whose mean side is `side_px`. Leaves out
  // combinations of terms that change more over half a side (RMS over the markers) than from marker
  // to marker. Across a single row of markers, for example, such terms would be extrapolated to the
  // corners, which multiplies the noise of the motions. `motions` must not be empty, and their
  // weights are positive.
  MotionField(const std::vector<PlacedMotion>& motions, double side_px);

  MotionVector At(const Eigen::Vector2d& x_in_image_px) const;

 private:
  Eigen::Vector2d PlaceOf(const Eigen::Vector2d& x_in_image_px) const;

  Eigen::Vector2d center_px_ = Eigen::Vector2d::Zero();
  double unit_px_ = 1.0;  // of places, so that all terms are of about the same size
  Terms mean_terms_ = Terms::Zero();
  MotionVector mean_ = MotionVector::Zero();
  Eigen::Matrix<double, kNumTerms, MotionVector::RowsAtCompileTime> coefficients_;
};

}  // namespace velamap
