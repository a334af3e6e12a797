// Finds a known marker near the place where it is expected, which in a video replaces a search.

#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "importer/detect/marker_alignment.h"

namespace velamap {

// The marker within `reach_px` of `expected`, which has its shape to about a cell. Nothing unless
// all cells look as they should; corners are good to a tenth of a pixel.
std::optional<QuadCorners> LocateMarker(const cv::Mat& gray, const QuadCorners& expected,
                                        const MarkerLook& look, double reach_px);

}  // namespace velamap
