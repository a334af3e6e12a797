#include "exporters/shape/part_axes.h"

#include <cmath>

#include <Eigen/Geometry>

#include "exporters/shape/sail_lines.h"
#include "importer/geometry/principal_axes.h"

namespace velamap {

bool SpanPlane(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  constexpr double kMinSine = 0.05;
  return a.cross(b).norm() > kMinSine * a.norm() * b.norm();
}

std::optional<PartAxes> FitPartAxes(const MarkerShape& shape, const std::vector<int>& ids) {
  PartAxes part{Eigen::Vector3d::Zero(), {}, Eigen::Vector3d::Zero()};
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> corners;
  for (const int id : ids) {
    const ShapeMarker& marker = *FindWholeMarker(shape, id);
    for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
      corners.push_back(*marker.x_in_shape_m[corner]);
    }
    facing += MarkerNormal(marker);
    part.marker_up += MarkerUp(marker);
  }
  const PrincipalAxes principal = ComputePrincipalAxes(corners);
  part.center = principal.mean;
  const Eigen::Vector3d along = CenterOf(shape, ids.back()) - CenterOf(shape, ids.front());
  // A strip around a curved side is about as thick as it is wide, and noise would turn its plane.
  constexpr double kMinSpreadRatio = 4.0;  // of variances
  part.is_flat = principal.sums_of_squares[1] >= kMinSpreadRatio * principal.sums_of_squares[0];
  const Eigen::Vector3d normal =
      part.is_flat ? principal.directions.col(0).eval() : facing.normalized();
  if (!SpanPlane(along, normal)) return std::nullopt;
  if (part.is_flat) {
    part.axes[1] = normal;
    part.axes[0] = (along - normal.dot(along) * normal).normalized();
  } else {
    part.axes[0] = along.normalized();
    part.axes[1] = (normal - part.axes[0].dot(normal) * part.axes[0]).normalized();
  }
  part.axes[2] = part.axes[1].cross(part.axes[0]);
  return part;
}

int NearestAxis(const std::array<Eigen::Vector3d, 3>& axes, const Eigen::Vector3d& direction,
                int except) {
  int nearest = -1;
  for (int i = 0; i < 3; ++i) {
    if (i == except) continue;
    const auto closeness = [&](int axis) {
      return std::abs(axes[static_cast<std::size_t>(axis)].dot(direction));
    };
    if (nearest < 0 || closeness(i) > closeness(nearest)) nearest = i;
  }
  return nearest;
}

}  // namespace velamap
