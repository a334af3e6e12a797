// The borders at which the picture moves inwards, along which new markers can have come in.

#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/track/local_motion.h"

namespace velamap {

// How far the picture has moved inwards at the left, top, right and bottom border, px; negative:
// outwards.
using BorderInflow = std::array<double, 4>;

// `inflow_px` plus the inflow from the motions of a frame.
BorderInflow AddInflow(const std::vector<PointMotion>& motions, const cv::Size& size,
                       BorderInflow inflow_px);

// The bands along the borders at which new markers of up to `marker_px` can have come in. Resets
// the inflow of these borders.
std::vector<cv::Rect> BorderRegions(double marker_px, const cv::Size& size,
                                    BorderInflow* inflow_px);

}  // namespace velamap
