// Distances between adjacent markers against known ones (thesis sections 4.1, 4.2).

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
  // Of distance_m, where `covariance` holds the corners.
  std::optional<double> sigma_m = std::nullopt;
};

// Every pair that is adjacent in the layout's graph (neighbours on a line, all markers of a rigid
// part) and whole in both shapes, by ids. No alignment is involved, so the frames do not matter.
// Empty for a layout without lines or rigid parts.
std::vector<AdjacentDistance> CompareAdjacentDistances(const MarkerShape& shape,
                                                       const MarkerShape& reference,
                                                       const Layout& layout,
                                                       const PointCovariance* covariance = nullptr);

}  // namespace velamap
