// How well a surface is known, including the errors that its markers share.

#pragma once

#include <optional>

#include "exporters/surface/surface.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// Root mean square over the area of the sigma along the normal, m: from the joint covariance of the
// corners, or from the residuals of the surface if they show more noise, and from the smoothing.
// Returns nothing if there is no covariance (null), if it lacks a corner of the fit, or if the
// markers are interpolated.
std::optional<double> RmsSigma(const FittedSurface& fit, const PointCovariance* covariance);

}  // namespace velamap
