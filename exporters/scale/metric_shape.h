// From a bundle-adjusted model to the metric shape.

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

// Corners and centres of a metric model (unit m). Points whose id is no corner are left out. Sigmas
// are those of `covariance` where it is given; a centre's follows from its corners jointly.
MarkerShape ShapeFromModel(const Model& metric_model, const Layout& layout,
                           const PointCovariance* covariance = nullptr);

// Whether every corner of the shape lies where the model has it, to a micrometre: then a covariance
// of the model is the shape's.
bool IsShapeOf(const MarkerShape& shape, const Model& metric_model);

}  // namespace velamap
