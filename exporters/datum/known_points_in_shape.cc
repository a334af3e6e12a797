#include "exporters/datum/known_points_in_shape.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "exporters/shape/joint_covariance.h"

namespace velamap {
namespace {

std::optional<Eigen::Vector3d> PointInShape(const MarkerShape& shape, const KnownPoint& known) {
  const ShapeMarker* marker = FindMarker(shape, known.marker_id);
  return marker == nullptr ? std::nullopt
                           : marker->x_in_shape_m[static_cast<std::size_t>(known.corner)];
}

}  // namespace

KnownPointsInShape CollectKnownPointsInShape(const MarkerShape& shape,
                                             const std::vector<KnownPoint>& known,
                                             const PointCovariance* covariance) {
  KnownPointsInShape present;
  std::vector<CornerId> found;
  DatumPoints& points = present.points;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const std::optional<Eigen::Vector3d> x = PointInShape(shape, known[i]);
    if (!x) continue;
    if (!known[i].is_check) present.datum_idxs.push_back(points.points.size());
    present.known_idxs.push_back(i);
    found.push_back({known[i].marker_id, known[i].corner});
    points.points.push_back({*x, known[i].x_m, known[i].sigma_m});
    points.center_in_shape_m += *x;
  }
  if (found.empty()) return present;
  const auto count = static_cast<double>(found.size());
  points.center_in_shape_m /= count;
  double squared_m2 = 0.0;
  for (DatumPoint& point : points.points) {
    point.x_m -= points.center_in_shape_m;
    squared_m2 += point.x_m.squaredNorm() / count;
  }
  constexpr double kMinRadius_m = 1e-4;  // keeps divisions by the radius finite
  points.radius_m = std::max(kMinRadius_m, std::sqrt(squared_m2));
  points.covariance_m2 = JointCovarianceOfPoints(covariance, found);
  return present;
}

}  // namespace velamap
