// Grey values at places of an image, in OpenCV's pixel frame.

#pragma once

#include <algorithm>
#include <cstdint>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace velamap {

// The value of the pixel at a place; outside of the image, of the nearest one inside.
inline std::uint8_t NearestGray(const cv::Mat& gray, const cv::Point2f& x_px) {
  return gray.at<std::uint8_t>(std::clamp(cvRound(x_px.y), 0, gray.rows - 1),
                               std::clamp(cvRound(x_px.x), 0, gray.cols - 1));
}

// Bilinear value of a grey image at a place. Outside of the image, the nearest value inside; a
// coordinate that is not a number counts as 0.
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
