// PNG files, and markers as PNG pictures that know their own size.

#pragma once

#include <optional>
#include <string>

#include <opencv2/core.hpp>

namespace velamap {

// The bytes of a file with `image` (8 bit, grey or BGR). `px_per_mm` is stored as its resolution.
std::string EncodePng(const cv::Mat& image, std::optional<double> px_per_mm = std::nullopt);

// The bytes of a PNG of the cells (zero is dark, CV_8UC1) with `margin_mm` of white around them, a
// whole number of pixels per cell and at least `dpi`. Its resolution (pHYs) makes the cells
// together `length_mm` wide where programs keep to it.
std::string MarkerPng(const cv::Mat& cells, double length_mm, double margin_mm, double dpi);

}  // namespace velamap
