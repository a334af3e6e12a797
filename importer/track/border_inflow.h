// Where new markers can have come into the picture: along the borders at which it moves inwards.

#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/track/local_motion.h"

namespace velamap {

// How far the picture has come in at the left, top, right and bottom border, px; negative: it went
// out.
using BorderInflow = std::array<double, 4>;

// `inflow_px` and what the motions of a frame add to it.
BorderInflow AddInflow(const std::vector<PointMotion>& motions, const cv::Size& size,
                       BorderInflow inflow_px);

// The bands along the borders at which new markers can have come in, none larger than
// `marker_px`; their inflow starts again.
std::vector<cv::Rect> BorderRegions(double marker_px, const cv::Size& size,
                                    BorderInflow* inflow_px);

}  // namespace velamap
