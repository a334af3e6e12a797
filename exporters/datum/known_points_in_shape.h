// Collects the known points of the layout that are in the shape.

#pragma once

#include <vector>

#include "exporters/datum/datum_equations.h"
#include "exporters/shape/marker_shape.h"
#include "importer/layout/known_point.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

struct KnownPointsInShape {
  std::vector<std::size_t> known_idxs;  // ascending indices into the known points of the layout
  DatumPoints points;                   // in the order of `known_idxs`
  PointSet datum_idxs;                  // indices into `points` of those that are not checks
};

// `covariance` may be null. Points that it lacks count as exact.
KnownPointsInShape CollectKnownPointsInShape(const MarkerShape& shape,
                                             const std::vector<KnownPoint>& known,
                                             const PointCovariance* covariance);

}  // namespace velamap
