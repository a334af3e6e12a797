// Makes detections and pictures of markers.

#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>

#include "importer/detect/detection.h"
#include "importer/geometry/units.h"

namespace velamap {

// An upright square of the given side around a centre, px.
inline MarkerDetection SquareMarker(int marker_id, double x, double y, double side = 20.0) {
  MarkerDetection marker;
  marker.marker_id = marker_id;
  const double h = 0.5 * side;
  marker.corners_in_image_px = {Eigen::Vector2d(x - h, y - h), Eigen::Vector2d(x + h, y - h),
                                Eigen::Vector2d(x + h, y + h), Eigen::Vector2d(x - h, y + h)};
  return marker;
}

// A square of 20 px whose top side runs at the angle, corners numbered from `first` on.
inline MarkerDetection TurnedMarker(int id, double x, double y, double angle_deg, int first = 0) {
  MarkerDetection marker;
  marker.marker_id = id;
  const double a = angle_deg * kRadPerDeg;
  const Eigen::Vector2d right(std::cos(a), std::sin(a)), down(-std::sin(a), std::cos(a));
  const std::array<Eigen::Vector2d, 4> corners = {
      {-right - down, right - down, right + down, down - right}};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t from = (i + static_cast<std::size_t>(first)) % 4;
    marker.corners_in_image_px[i] = Eigen::Vector2d(x, y) + 10 * corners[from];
    marker.colors[i] = {static_cast<std::uint8_t>(from), 0, 0};
    marker.corner_sigma_px[i] = 0.01 * static_cast<double>(from + 1);
  }
  return marker;
}

struct DrawnMarker {
  int marker_id = 0;
  int left = 0;  // first pixel column and row of the black square
  int top = 0;
  int side = 96;  // px, a multiple of the number of cells
};

// A light grey picture with upright markers. The outline of a drawn square runs along pixel edges,
// so its exact corners are (left, top) and (left + side, top + side) in the image frame.
inline cv::Mat DrawMarkers(const cv::Ptr<cv::aruco::Dictionary>& dictionary, const cv::Size& size,
                           const std::vector<DrawnMarker>& markers, int border_bits = 1) {
  cv::Mat image(size, CV_8UC3, cv::Scalar(200, 200, 200));
  for (const DrawnMarker& marker : markers) {
    cv::Mat drawn;
    cv::aruco::drawMarker(dictionary, marker.marker_id, marker.side, drawn, border_bits);
    drawn = drawn * (160.0 / 255.0) + 40;
    cv::Mat color;
    cv::cvtColor(drawn, color, cv::COLOR_GRAY2BGR);
    color.copyTo(image(cv::Rect(marker.left, marker.top, marker.side, marker.side)));
  }
  return image;
}

}  // namespace velamap
