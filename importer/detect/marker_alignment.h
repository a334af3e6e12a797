// A known marker near a place where it is expected: for a video, instead of a search, and for the
// corner fits, which then start within a fraction of a pixel wherever a quad came from.

#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "importer/detect/marker_search.h"

namespace velamap {

// What a marker looks like. `cells`: 8-bit, square, with the black border, zero for black; row 0
// runs from corner 0 to 1 and column 0 from corner 0 to 3. An inverted one is light where these are
// dark.
struct MarkerLook {
  cv::Mat cells;
  bool is_inverted = false;
};

// The quad along whose sides the grey level is halfway between the black border and what surrounds
// it. Corners in OpenCV's pixel frame; `quad` is off by less than half a cell. Nothing where a side
// is not to be seen.
std::optional<QuadCorners> AlignSides(const cv::Mat& gray, const QuadCorners& quad,
                                      const MarkerLook& look);

// The marker within `reach_px` of `expected`, whose shape is known to about a cell: where all of
// its cells look as they should. Nothing if there is no such place; corners to a tenth of a pixel.
std::optional<QuadCorners> LocateMarker(const cv::Mat& gray, const QuadCorners& expected,
                                        const MarkerLook& look, double reach_px);

}  // namespace velamap
