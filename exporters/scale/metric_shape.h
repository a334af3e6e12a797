// Derives the metric shape from a bundle-adjusted model.

#pragma once

#include "exporters/scale/metric_scale.h"
#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Scales points and camera positions; the world frame keeps its origin and axes and becomes the
// shape frame.
void ScaleModel(const ScaleEstimate& scale, Model* model);

// Collects the corners of a metric model (unit m) and computes the centres. Ignores points whose id
// is no corner. Sigmas come from `covariance` (may be null); the sigma of a centre takes the
// correlation of its corners into account.
MarkerShape ShapeFromModel(const Model& metric_model, const Layout& layout,
                           const PointCovariance* covariance = nullptr);

// Whether every corner of the shape has the position of the model's point to a micrometre, so that
// the covariance of the model applies to the shape.
bool IsShapeOf(const MarkerShape& shape, const Model& metric_model);

}  // namespace velamap
