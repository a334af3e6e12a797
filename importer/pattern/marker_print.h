// What is printed of a marker: its cells and its size.

#pragma once

#include <opencv2/core.hpp>

namespace velamap {

struct MarkerPrint {
  // 8-bit, square, with the black border, zero for black. Row 0 runs from corner 0 to 1 and column
  // 0 from corner 0 to 3.
  cv::Mat cells;
  double side_mm = 100.0;  // of the black square; ink spreads by a length on the paper
};

}  // namespace velamap
