#include "exporters/formats/float_step.h"

#include <algorithm>
#include <limits>

#include <Eigen/Geometry>

namespace velamap {

std::optional<double> CoarseFloatStep_m(const std::vector<Eigen::Vector3d>& points_m) {
  constexpr double kRelativeStep = std::numeric_limits<float>::epsilon();
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& x_m : points_m) box.extend(x_m);
  if (box.isEmpty()) return std::nullopt;
  const double farthest_m = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  const double step_m = kRelativeStep * farthest_m;
  const double least_m = kRelativeStep * box.sizes().maxCoeff();
  if (step_m <= std::max(kMaxFloatStep_m, least_m)) return std::nullopt;
  return step_m;
}

}  // namespace velamap
