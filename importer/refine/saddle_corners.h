// Corners where another dark square touches the marker's diagonally, as on an AprilGrid.
//
// Two edges of the marker and two of the other square meet in a saddle point of the grey levels.
// cv::cornerSubPix finds it without bias, and spreading ink or light does not move it, while it
// moves the sides of the marker. On photographs of a printed AprilGrid the sides are off by 0.5 %,
// the saddle points by less than 0.1 %.

#pragma once

#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"

namespace velamap {

// How far the corner of a marker may be from the saddle point, in cells. Where a light gap is left
// between the corners of two markers, its middle is a saddle point as well, but not their corner.
// On photographs of a printed AprilGrid, 99 % of the saddle points are within 0.10 cells of the
// fit.
constexpr double kSaddleReachOfFit = 0.15;  // from the fit of the marker's pattern
constexpr double kSaddleReachOfQuad = 0.5;  // from the outline of the detector

// Moves the corners of the marker (OpenCV's pixel frame) that are saddle points onto these, and
// leaves the others. `cells` as in pattern_fit.h; cells below 4 px are too small. Returns the
// number of corners that were moved.
int RefineSaddleCorners(const cv::Mat& gray, const cv::Mat& cells, double reach_cells,
                        QuadCorners* corners_px);

}  // namespace velamap
