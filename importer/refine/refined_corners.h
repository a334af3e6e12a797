// What a fit of a marker's corners finds, and the noise of the pixels that it was found from.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>

#include "importer/geometry/quad.h"

namespace velamap {

struct RefinedCorners {
  QuadCorners corners_px;  // OpenCV's pixel frame
  // 1 sigma of a coordinate by the image's noise: root mean square over x and y.
  std::array<double, kNumCorners> sigma_px{};
};

// The noise of pixels from what a least-squares fit leaves of them. Each counts by its weight, the
// squared slope of the grey values: what moves a corner is the noise on the edges, and pixels
// beside them may have none where black and white are clipped.
class ResidualNoise {
 public:
  ResidualNoise() = default;
  // Sums over pixels: of weight * residual^2, and of weight * (1 - leverage), where leverage is the
  // part of the pixel's own noise that the fit follows.
  ResidualNoise(double weighted_squares, double weights)
      : weighted_squares_(weighted_squares), weights_(weights) {}

  void Add(const ResidualNoise& other) {
    weighted_squares_ += other.weighted_squares_;
    weights_ += other.weights_;
  }

  // Variance of a pixel. An 8-bit picture without noise still rounds: no less than a step's 1/12.
  double VarianceGray() const {
    constexpr double kRounding = 1.0 / 12;
    return weights_ > 0 ? std::max(weighted_squares_ / weights_, kRounding) : kRounding;
  }

 private:
  double weighted_squares_ = 0.0, weights_ = 0.0;
};

}  // namespace velamap
