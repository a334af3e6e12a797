// Grey values between pixels.

#pragma once

#include <algorithm>
#include <cstdint>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace velamap {

// Bilinear value of a grey image at a place in OpenCV's pixel frame. Outside of the image, the
// nearest value inside; a coordinate that is not a number counts as 0.
template <typename Pixel = std::uint8_t>
double InterpolateGray(const cv::Mat& gray, const Eigen::Vector2d& x_px) {
  // In this order of arguments std::max turns NaN into 0.
  const double x = std::min(std::max(0.0, x_px.x()), gray.cols - 1.001);
  const double y = std::min(std::max(0.0, x_px.y()), gray.rows - 1.001);
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const double fx = x - column, fy = y - row;
  const Pixel* upper = gray.ptr<Pixel>(row) + column;
  const Pixel* lower = gray.ptr<Pixel>(row + 1) + column;
  return (1 - fy) * ((1 - fx) * upper[0] + fx * upper[1]) +
         fy * ((1 - fx) * lower[0] + fx * lower[1]);
}

}  // namespace velamap
