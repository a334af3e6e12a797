// Compares distances between adjacent markers with known ones (thesis sections 4.1 and 4.2).

#pragma once

#include <optional>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// Between the centres of two markers, m.
struct AdjacentDistance {
  int marker_id1 = 0, marker_id2 = 0;
  double distance_m = 0.0;
  double reference_distance_m = 0.0;
  // 1 sigma of distance_m; known if `covariance` has the corners.
  std::optional<double> sigma_m = std::nullopt;
};

// Returns every pair that is adjacent in the layout's graph (neighbours on a line, all markers of a
// rigid part) and whole in both shapes, sorted by ids. The shapes may be in different frames. Empty
// for a layout without lines or rigid parts.
std::vector<AdjacentDistance> CompareAdjacentDistances(const MarkerShape& shape,
                                                       const MarkerShape& reference,
                                                       const Layout& layout,
                                                       const PointCovariance* covariance = nullptr);

}  // namespace velamap
