// Result of a fit of a marker's corners, and the noise of the pixels that were fitted.

#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"

namespace velamap {

struct RefinedCorners {
  QuadCorners corners_px;  // OpenCV's pixel frame
  // 1 sigma of a coordinate from the noise of the image: root mean square over x and y.
  std::array<double, kNumCorners> sigma_px{};
  // Of a fit of the whole marker: RMS of the residuals of all pixels, grey levels, and the cells
  // (column, row) that look as if they were of the other colour.
  double rms_gray = 0.0;
  std::vector<cv::Point> mismatched_cells{};
};

// The noise of pixels from the residuals of a least-squares fit. Each pixel is weighted by the
// squared slope of the grey levels, because only noise on the edges moves a corner, and pixels
// beside them may have none where black and white are clipped.
class ResidualNoise {
 public:
  ResidualNoise() = default;
  // Sums over pixels of weight * residual^2 and of weight * (1 - leverage); the leverage of a pixel
  // is the fraction of its noise that the fit follows.
  ResidualNoise(double weighted_squares, double weights)
      : weighted_squares_(weighted_squares), weights_(weights) {}

  void Add(const ResidualNoise& other) {
    weighted_squares_ += other.weighted_squares_;
    weights_ += other.weights_;
  }

  // Variance of a pixel, at least 1/12 for the rounding of an 8-bit image.
  double VarianceGray() const {
    constexpr double kRounding = 1.0 / 12;
    return weights_ > 0 ? std::max(weighted_squares_ / weights_, kRounding) : kRounding;
  }

 private:
  double weighted_squares_ = 0.0, weights_ = 0.0;
};

}  // namespace velamap
