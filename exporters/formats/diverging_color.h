// Colours of signed distances.

#pragma once

#include <optional>

#include <Eigen/Core>

namespace velamap {

// Blue, white and red (0 to 255) for -limit, 0 and +limit, clamped beyond; grey for an unknown
// distance; white for a limit of 0. The scale is ColorBrewer's RdBu, which suits all kinds of
// colour vision.
Eigen::Array3d DivergingColor(const std::optional<double>& distance_m, double limit_m);

}  // namespace velamap
