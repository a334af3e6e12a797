// Colours of signed distances.

#pragma once

#include <optional>

#include <Eigen/Core>

namespace velamap {

// Blue, white, red for -limit, 0, +limit and beyond (ColorBrewer's RdBu, which colour-blind eyes
// tell apart), 0 to 255; grey for a distance that is not known. White for a limit of 0.
Eigen::Array3d DivergingColor(const std::optional<double>& distance_m, double limit_m);

}  // namespace velamap
