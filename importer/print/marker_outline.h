// The black cells of a marker as outlines.

#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace velamap {

// Outlines of the dark cells (zero in `cells`, CV_8UC1), in units of cells from the top left
// corner. Outer outlines run clockwise as seen on the page, and holes counterclockwise. Cells that
// touch only at a corner have separate outlines there. No edge lies between two dark cells, because
// printers and viewers would show a hairline there.
std::vector<std::vector<Eigen::Vector2d>> OutlineDarkCells(const cv::Mat& cells);

}  // namespace velamap
