// A marker as a PNG picture that knows its own size.

#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace velamap {

// The bytes of a PNG of the cells (zero is dark, CV_8UC1) with `margin_mm` of white around them, a
// whole number of pixels a cell and at least `dpi`. Its resolution (pHYs) makes the cells together
// `length_mm` wide where programs keep to it.
std::string MarkerPng(const cv::Mat& cells, double length_mm, double margin_mm, double dpi);

}  // namespace velamap
