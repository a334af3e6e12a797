// A picture full of markers with exact corners, and starts near them.

#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"
#include "tests/support/render/marker_renderer.h"

namespace velamap {

struct MarkerGridOptions {
  std::string dictionary = "DICT_5X5_50";
  double side_px = 25.0;  // upright; tilted markers are smaller
  double min_tilt_deg = 0.0, max_tilt_deg = 60.0;
  double start_error_px = 0.7;  // of each coordinate of a start corner, uniform
  Camera camera{CameraModel::kPinhole, 640, 480, {900, 900, 320, 240}};
  RenderOptions rendering;
};

struct MarkerGrid {
  cv::Mat image;
  std::vector<cv::Mat> cells;  // of each marker, as FitPattern wants them
  std::vector<QuadCorners> truth, starts;
};

// A chequered board: one cell of quiet zone, then black.
MarkerGridOptions Chequered(double side_px, double blur_px);

// Markers in random attitudes on a grid, apart from each other.
MarkerGrid MakeMarkerGrid(const MarkerGridOptions& options);

// cv::cornerSubPix as its users would call it: with a window of less than half a cell, so that it
// holds no other corner. `num_cells`: along a side, with the border.
QuadCorners SubpixCorners(const cv::Mat& gray, const QuadCorners& start, int num_cells);

}  // namespace velamap
