// The black cells of a marker as outlines.

#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace velamap {

// Outlines of the dark cells (zero in `cells`, CV_8UC1), in cells from the top left corner; outer
// ones clockwise as seen, holes the other way round. Cells that touch at a corner only have
// outlines of their own there. No edge lies between two dark cells, so that no printer or viewer
// shows a hairline between them.
std::vector<std::vector<Eigen::Vector2d>> OutlineDarkCells(const cv::Mat& cells);

}  // namespace velamap
