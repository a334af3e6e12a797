// Corners where another dark square touches the marker's diagonally, as on an AprilGrid.
//
// There two edges of the marker and two of the other square meet in a saddle point of the grey
// values, which cv::cornerSubPix finds without bias and which stays in place when ink or light
// spreads, while the marker's sides move. On photographs of a printed AprilGrid the sides are 0.5 %
// off, the saddle points less than 0.1 %.

#pragma once

#include <array>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"

namespace velamap {

// Moves those of the marker's corners (OpenCV's pixel frame, good to half a cell) that are saddle
// points onto them, and leaves the others. `num_cells` is the number of cells along a side with the
// border. Cells under 4 px are too small to tell. Returns how many were moved.
int RefineSaddleCorners(const cv::Mat& gray, int num_cells, QuadCorners* corners_px);

}  // namespace velamap
