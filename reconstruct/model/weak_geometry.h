// Tells whether the images determine the shape well.

#pragma once

#include <string>

#include "reconstruct/geometry/point_covariance.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Returns a warning for a metric model whose points are poorly determined along the line of sight,
// with the likely reason: all images from one place, a flat object seen head-on, markers that the
// images from other places do not show, hardly any parallax. Empty for good geometry; an uncertain
// scale of the whole is not weak geometry. Throws DataError if the points are uncertain by more
// than a fifth of the object's extent.
std::string FindWeakGeometry(const Model& model, const PointCovariance& points);

// Whether FindWeakGeometry() made the warning.
bool IsWeakGeometryWarning(const std::string& warning);

}  // namespace velamap
