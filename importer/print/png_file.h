// Encodes PNG files, and draws markers as PNG pictures with their printed size.

#pragma once

#include <optional>
#include <string>

#include <opencv2/core.hpp>

namespace velamap {

// The bytes of a PNG file with `image` (8 bit, grey or BGR). `px_per_mm` is stored as its
// resolution (pHYs).
std::string EncodePng(const cv::Mat& image, std::optional<double> px_per_mm = std::nullopt);

// The bytes of a PNG file of the cells (CV_8UC1, zero is black) with a white margin of `margin_mm`.
// A cell is a whole number of pixels wide, the smallest that gives at least `dpi`. Programs that
// respect the stored resolution print the cells `length_mm` wide.
std::string MarkerPng(const cv::Mat& cells, double length_mm, double margin_mm, double dpi);

}  // namespace velamap
