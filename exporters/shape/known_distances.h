// The layout's distances, measured by hand, against the result.

#pragma once

#include <optional>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

struct CheckedDistance {
  KnownDistance known;
  std::optional<double> distance_m;  // of the shape; nothing where it lacks one of the points
  std::optional<double> sigma_m;     // of distance_m

  // Of the difference: the tape's and, where it is known, the result's.
  double DifferenceSigma() const;
};

// In the layout's order.
std::vector<CheckedDistance> CheckDistances(const MarkerShape& shape, const Layout& layout,
                                            const PointCovariance* covariance = nullptr);

}  // namespace velamap
