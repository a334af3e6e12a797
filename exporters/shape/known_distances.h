// Compares the distances of the layout, measured by hand, with the result.

#pragma once

#include <optional>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

struct CheckedDistance {
  KnownDistance known;
  std::optional<double> distance_m;  // in the shape; nothing if it lacks one of the points
  std::optional<double> sigma_m;     // of distance_m

  // Sigma of the difference: that of the tape and, if known, that of the result.
  double DifferenceSigma() const;
};

// One entry per distance of the layout, in its order.
std::vector<CheckedDistance> CheckDistances(const MarkerShape& shape, const Layout& layout,
                                            const PointCovariance* covariance = nullptr);

}  // namespace velamap
