// Finds a known marker near the place where it is expected, which in a video replaces a search.

#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "importer/detect/marker_alignment.h"

namespace velamap {

// Returns the corners, to a tenth of a pixel, of the marker within `reach_px` of `expected`, whose
// shape must be right to about one cell. Returns nothing unless all cells look as they should.
std::optional<QuadCorners> LocateMarker(const cv::Mat& gray, const QuadCorners& expected,
                                        const MarkerLook& look, double reach_px);

}  // namespace velamap
