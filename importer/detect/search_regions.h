// Parts of an image in which markers are to be searched.

#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"

namespace velamap {

// Whether a marker may lie in the image as a whole, its place known to `margin_px`; a negative one
// asks whether it does for sure.
bool FitsIn(const Box& box, const cv::Size& size, double margin_px);

// Where a marker is to be searched, its place known to `margin_px`.
cv::Rect RegionAround(const Box& box, const cv::Size& size, double margin_px);

double AreaOf(const std::vector<cv::Rect>& regions);  // px, where they overlap more than once

// Rectangles that cover what `regions` cover, joined where one costs less than two.
std::vector<cv::Rect> MergeRegions(std::vector<cv::Rect> regions);

}  // namespace velamap
