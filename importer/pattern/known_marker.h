// What is known of a marker before its pixels are fitted.

#pragma once

#include <opencv2/core.hpp>

#include "importer/bend/pattern_bend.h"

namespace velamap {

struct KnownMarker {
  // 8-bit, square, with the black border, zero for black. Row 0 runs from corner 0 to 1 and column
  // 0 from corner 0 to 3.
  cv::Mat cells;
  double side_mm = 100.0;   // of the black square; ink spreads by a length on the paper
  PatternBend lens_bend{};  // at the place where the marker was found
};

}  // namespace velamap
