// From a bundle-adjusted model to the metric shape.

#pragma once

#include "exporters/marker_shape.h"
#include "exporters/metric_scale.h"
#include "importer/layout.h"
#include "reconstruct/model.h"

namespace velamap {

// Scales points and camera positions; the world frame keeps its origin and axes and becomes the
// shape frame.
void ScaleModel(const ScaleEstimate& scale, Model* model);

// Corners and centres of a metric model (unit m). Points whose id is no corner are left out.
MarkerShape ShapeFromModel(const Model& metric_model, const Layout& layout);

}  // namespace velamap
