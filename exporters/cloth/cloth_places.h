// Where the cloth is in the middle of each marker. A marker bends with the cloth it sticks to, so
// that the mean of its corners, which counts as its centre, lies inside the bend: by
// a^2 (k1 + k2) / 2 for a side of 2 a and principal curvatures k1 and k2, some millimetres at the
// luff of a narrow head. Sections through the centres would be too flat, and turned at the head.

#pragma once

#include <optional>

#include <Eigen/Core>

#include "exporters/shape/marker_shape.h"
#include "exporters/surface/surface.h"
#include "importer/layout/layout.h"

namespace velamap {

// Moves the centres of the markers of the fit to the cloth, along the normal of the surface. The
// corners stay. `fit` is a surface through markers of the shape, in its frame.
void MoveCentersToCloth(const FittedSurface& fit, MarkerShape* shape);

// The same for all parts of the layout with horizontal lines, by surfaces through their markers.
// The centres of a part without a surface stay. `up_in_shape` as for CollectSurfaceInput().
void MoveCentersToCloth(const Layout& layout, const std::optional<Eigen::Vector3d>& up_in_shape,
                        MarkerShape* shape);

}  // namespace velamap
