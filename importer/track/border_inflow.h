// Measures how far the picture has moved inwards at each of its borders, where new markers may have
// entered.

#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/track/local_motion.h"

namespace velamap {

// How far the picture has moved inwards at the left, top, right and bottom border, px; negative:
// outwards.
using BorderInflow = std::array<double, 4>;

// Returns `inflow_px` plus the inflow that the motions of a frame show.
BorderInflow AddInflow(const std::vector<PointMotion>& motions, const cv::Size& size,
                       BorderInflow inflow_px);

// Returns the bands along the borders in which new markers of up to `marker_px` may have appeared,
// and resets the inflow of these borders to zero.
std::vector<cv::Rect> BorderRegions(double marker_px, const cv::Size& size,
                                    BorderInflow* inflow_px);

}  // namespace velamap
