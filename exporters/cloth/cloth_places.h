// Where the cloth is in the middle of each marker. A marker bends with the cloth it sticks to, so
// that the mean of its corners, which counts as its centre, lies inside the bend: by
// a^2 (k1 + k2) / 2 for a side of 2 a and principal curvatures k1 and k2, some millimetres at the
// luff of a narrow head. Sections through the centres would be too flat, and turned at the head.

#pragma once

#include <map>
#include <optional>

#include <Eigen/Core>

#include "exporters/shape/marker_shape.h"
#include "exporters/surface/surface.h"
#include "importer/layout/layout.h"

namespace velamap {

// From the centre of each marker to the cloth, along the normal of the surface, by marker id, m.
using ClothOffsets = std::map<int, Eigen::Vector3d>;

// `fit` is a surface through markers; the offsets are in its frame.
ClothOffsets OffsetsToCloth(const FittedSurface& fit);

// The same for all parts of the layout with horizontal lines, by surfaces through their markers.
// Parts whose markers determine no surface have none. `up_in_shape` as for CollectSurfaceInput().
ClothOffsets OffsetsToCloth(const MarkerShape& shape, const Layout& layout,
                            const std::optional<Eigen::Vector3d>& up_in_shape);

// Moves the centres of the markers. The corners stay.
void MoveCenters(const ClothOffsets& offsets_m, MarkerShape* shape);

}  // namespace velamap
