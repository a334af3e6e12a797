// How a marker is exposed and how sharp its border is.

#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"

namespace velamap {

struct MarkerLight {
  double black = 0.0;  // grey level of the border, 0 to 255
  double white = 0.0;  // grey level of the paper around it
  // Sigmas of the blur across the two pairs of opposite sides, px; the larger one includes the
  // motion during the exposure.
  double least_blur_px = 0.0;
  double most_blur_px = 0.0;
};

// From the grey levels across the middle of each side, of a marker with a black border on white
// paper. Returns nothing if a side is too near the border of the image, or without contrast.
std::optional<MarkerLight> MeasureLight(const cv::Mat& gray, const QuadCorners& corners_px);

}  // namespace velamap
