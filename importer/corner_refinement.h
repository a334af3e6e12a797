// Sub-pixel corners of a dark square on light ground as intersections of fitted edges.
//
// cv::cornerSubPix pulls a marker's corners inwards by 0.1 to 0.4 px, which scaling by the marker's
// side turns into a scale error of 0.4 to 6 %. Here each side is modelled as a straight step edge
// blurred by a Gaussian,
//
//   I(d) = dark + (light - dark) * (1 + erf(d / (sqrt(2) blur))) / 2,   d = distance outwards, px
//
// whose line and blur are fitted by least squares to the pixels within a band around the side, the
// band no wider than the marker's own border and quiet zone. The corners are the intersections of
// neighbouring lines.

#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/ids.h"

namespace velamap {

struct EdgeFitOptions {
  // Half width of the band around a side as a fraction of a cell, and its limits in px.
  double band_in_cells = 0.6;
  double min_band_px = 1.5;
  double max_band_px = 6.0;
  // A corner that the fit moves further than this many cells (but at least 1.5 px) is a failure.
  double max_shift_in_cells = 0.8;
};

// `corners_px` in OpenCV's pixel frame (first pixel's centre at (0,0)), in order around the square,
// the refined ones likewise. `num_cells` is the number of cells along a side with the border.
// Nothing if an edge has too little contrast, leaves the image, or the fit moves a corner too far.
std::optional<std::array<Eigen::Vector2d, kNumCorners>> RefineCornersByEdges(
    const cv::Mat& gray, const std::array<Eigen::Vector2d, kNumCorners>& corners_px, int num_cells,
    const EdgeFitOptions& options = {});

}  // namespace velamap
