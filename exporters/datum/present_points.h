// The known points of the layout that are in the shape.

#pragma once

#include <vector>

#include "exporters/datum/datum_equations.h"
#include "exporters/shape/marker_shape.h"
#include "importer/layout/known_point.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

struct PresentPoints {
  std::vector<std::size_t> idxs;  // ascending, into the known points
  DatumPoints points;             // in the same order
  PointSet datum;                 // indices into `points` of those that are no checks
};

// `covariance` may be null; points that it lacks count as exact.
PresentPoints CollectPresent(const MarkerShape& shape, const std::vector<KnownPoint>& known,
                             const PointCovariance* covariance);

}  // namespace velamap
