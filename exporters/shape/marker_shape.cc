#include "exporters/shape/marker_shape.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>

#include "importer/geometry/principal_axes.h"

namespace velamap {
namespace {

// Cross product of the diagonals: along the outward normal, with twice the area as its length.
// Corners 1..4 are top-left, top-right, bottom-right, bottom-left with y up, clockwise seen from
// the front.
Eigen::Vector3d DiagonalProduct(const ShapeMarker& marker) {
  VELAMAP_CHECK(marker.IsWhole());
  const auto& x = marker.x_in_shape_m;
  return (*x[2] - *x[4]).cross(*x[1] - *x[3]);
}

std::vector<Eigen::Vector3d> AllCorners(const MarkerShape& shape) {
  std::vector<Eigen::Vector3d> points;
  for (const ShapeMarker& marker : shape.markers) {
    for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
      if (marker.x_in_shape_m[corner]) points.push_back(*marker.x_in_shape_m[corner]);
    }
  }
  return points;
}

// Columns are axes of unit length.
Eigen::Matrix3d MarkerAxes(const ShapeMarker& marker) {
  const Eigen::Vector3d normal = MarkerNormal(marker);
  const Eigen::Vector3d side = *marker.x_in_shape_m[2] - *marker.x_in_shape_m[1];
  Eigen::Matrix3d axes;
  axes.col(2) = normal;
  axes.col(0) = (side - side.dot(normal) * normal).normalized();
  axes.col(1) = normal.cross(axes.col(0));
  return axes;
}

}  // namespace

double SigmaOfCoordinate(const Eigen::Vector3d& sigma_m) {
  return std::sqrt(sigma_m.squaredNorm() / 3);
}

std::optional<Eigen::Vector3d> MeanOfCorners(const ShapeMarker& marker) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
    if (!marker.x_in_shape_m[corner]) return std::nullopt;
    sum += *marker.x_in_shape_m[corner];
  }
  return sum / kNumCorners;
}

void SetCenter(ShapeMarker* marker) {
  marker->x_in_shape_m[0] = MeanOfCorners(*marker);
  if (!marker->IsWhole()) return;
  marker->num_frames[0] =
      *std::min_element(marker->num_frames.begin() + 1, marker->num_frames.end());
}

const ShapeMarker* FindMarker(const MarkerShape& shape, int marker_id) {
  return FindMarkerById(shape.markers, marker_id);
}

const ShapeMarker* FindWholeMarker(const MarkerShape& shape, int marker_id) {
  const ShapeMarker* marker = FindMarker(shape, marker_id);
  return marker != nullptr && marker->IsWhole() ? marker : nullptr;
}

Eigen::Vector3d MarkerNormal(const ShapeMarker& marker) {
  return DiagonalProduct(marker).stableNormalized();
}

Eigen::Vector3d MarkerUp(const ShapeMarker& marker) {
  VELAMAP_CHECK(marker.IsWhole());
  const auto& x = marker.x_in_shape_m;
  return (*x[1] - *x[4] + *x[2] - *x[3]).normalized();
}

double MarkerArea(const ShapeMarker& marker) { return 0.5 * DiagonalProduct(marker).norm(); }

std::array<double, kNumCorners> MarkerSides(const ShapeMarker& marker) {
  VELAMAP_CHECK(marker.IsWhole());
  std::array<double, kNumCorners> sides;
  for (int i = 0; i < kNumCorners; ++i) {
    const int next = (i + 1) % kNumCorners;
    sides[i] = (*marker.x_in_shape_m[next + 1] - *marker.x_in_shape_m[i + 1]).norm();
  }
  return sides;
}

double MeanSide(const std::array<double, kNumCorners>& sides) {
  return std::accumulate(sides.begin(), sides.end(), 0.0) / kNumCorners;
}

Eigen::Vector3d BoundingBox(const MarkerShape& shape) {
  const std::vector<Eigen::Vector3d> points = AllCorners(shape);
  if (points.empty()) return Eigen::Vector3d::Zero();
  std::vector<Eigen::Matrix3d> candidates = {ComputePrincipalAxes(points).directions};
  for (const ShapeMarker& marker : shape.markers) {
    if (marker.IsWhole()) candidates.push_back(MarkerAxes(marker));
  }
  Eigen::Vector3d best;
  double least_surface = std::numeric_limits<double>::infinity();
  for (const Eigen::Matrix3d& axes : candidates) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& point : points) box.extend(axes.transpose() * point);
    const Eigen::Vector3d sides = box.sizes();
    const double surface = sides.x() * sides.y() + sides.y() * sides.z() + sides.z() * sides.x();
    if (surface < least_surface) {
      least_surface = surface;
      best = sides;
    }
  }
  std::sort(best.data(), best.data() + 3, std::greater<double>());
  return best;
}

}  // namespace velamap
