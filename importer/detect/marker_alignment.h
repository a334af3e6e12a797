// Moves a quad onto the sides of a known marker, so that corner fits start within a fraction of a
// pixel wherever the quad came from.

#pragma once

#include <optional>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/detect/marker_quad.h"

namespace velamap {

// What a marker looks like. `cells`: 8-bit, square, with the black border, zero for black; row 0
// runs from corner 0 to 1 and column 0 from corner 0 to 3. An inverted marker is light where these
// are dark.
struct MarkerLook {
  cv::Mat cells;
  bool is_inverted = false;
};

// Grey level at a place, taken from the negative if the marker is inverted.
double GrayAt(const cv::Mat& gray, const Eigen::Vector2d& x_px, const MarkerLook& look);

// The quad along whose sides the grey level is halfway between the black border and its
// surroundings. Corners in OpenCV's pixel frame; `quad` is off by less than half a cell. Returns
// nothing if the edge of a side cannot be found.
std::optional<QuadCorners> AlignSides(const cv::Mat& gray, const QuadCorners& quad,
                                      const MarkerLook& look);

// One round of AlignSides(), with scans that start from the sides of `quad`.
std::optional<QuadCorners> AlignSidesOnce(const cv::Mat& gray, const QuadCorners& quad,
                                          const MarkerLook& look);

}  // namespace velamap
