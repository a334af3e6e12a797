// Whether the images determine a shape well, in plain words.

#pragma once

#include <string>
#include <vector>

#include "reconstruct/geometry/point_covariance.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Warnings for a metric model whose points are poorly known along the line of sight, with the
// reason that the views suggest: all from one place, a flat object seen head-on, hardly any
// parallax. Empty for good geometry. Throws DataError where points are known so poorly that there
// is no shape (to a fifth of its extent).
std::vector<std::string> FindWeakGeometry(const Model& model, const PointCovariance& points);

}  // namespace velamap
