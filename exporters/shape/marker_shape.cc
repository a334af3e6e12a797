#include "exporters/shape/marker_shape.h"

#include <algorithm>
#include <numeric>

#include <Eigen/Geometry>

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

}  // namespace

const ShapeMarker* FindMarker(const MarkerShape& shape, int marker_id) {
  const auto it =
      std::lower_bound(shape.markers.begin(), shape.markers.end(), marker_id,
                       [](const ShapeMarker& marker, int id) { return marker.marker_id < id; });
  return it != shape.markers.end() && it->marker_id == marker_id ? &*it : nullptr;
}

const ShapeMarker* FindWholeMarker(const MarkerShape& shape, int marker_id) {
  const ShapeMarker* marker = FindMarker(shape, marker_id);
  return marker != nullptr && marker->IsWhole() ? marker : nullptr;
}

Eigen::Vector3d MarkerNormal(const ShapeMarker& marker) {
  return DiagonalProduct(marker).stableNormalized();
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

}  // namespace velamap
