// Regions of an image to search for markers.

#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"

namespace velamap {

// Whether the whole marker may lie in the image when its place is known to `margin_px`; with a
// negative margin, whether it certainly does.
bool FitsIn(const Box& box, const cv::Size& size, double margin_px);

// The pixels of the image that are at most `reach_px` from the box, in each direction.
cv::Rect PixelsAround(const Box& box, const cv::Size& size, double reach_px);

double TotalAreaPx(const std::vector<cv::Rect>& regions);  // px^2; overlaps count more than once

// The fixed cost of searching a region, in pixels.
constexpr int kCallCostPx = 4000;

// Rectangles that cover all `regions`, joined where one costs less than two.
std::vector<cv::Rect> MergeRegions(std::vector<cv::Rect> regions);

}  // namespace velamap
