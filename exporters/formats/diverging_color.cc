#include "exporters/formats/diverging_color.h"

#include <algorithm>
#include <cmath>

namespace velamap {

Eigen::Array3d DivergingColor(const std::optional<double>& distance_m, double limit_m) {
  const Eigen::Array3d blue(33, 102, 172), white(247, 247, 247), red(178, 24, 43);
  if (!distance_m) return Eigen::Array3d::Constant(128);
  const double part = limit_m > 0 ? std::clamp(*distance_m / limit_m, -1.0, 1.0) : 0.0;
  const Eigen::Array3d& end = part < 0 ? blue : red;
  const Eigen::Array3d color = white + std::abs(part) * (end - white);
  return color.round();
}

}  // namespace velamap
