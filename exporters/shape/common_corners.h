// The corners that two shapes share.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "exporters/shape/marker_shape.h"

namespace velamap {

// The same corners in both shapes, by marker and corner.
struct CommonCorners {
  std::vector<CornerId> ids;
  std::vector<Eigen::Vector3d> x_in_shape_m;
  std::vector<Eigen::Vector3d> x_in_reference_m;
};

// Without centres. `marker_ids` selects markers; an empty list selects all.
CommonCorners FindCommonCorners(const MarkerShape& shape, const MarkerShape& reference,
                                const std::vector<int>& marker_ids = {});

}  // namespace velamap
