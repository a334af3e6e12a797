// Distances of whole markers from a triangle mesh.

#pragma once

#include "exporters/design/mesh_distance.h"
#include "exporters/shape/marker_shape.h"

namespace velamap {

// The foot of a marker's centre on the mesh, with the distance of the marker as distance_m: how far
// its corners lie, on average, from where they would be on the mesh. The centre, which is the mean
// of the corners, has another distance where the mesh is bent: the corners of a marker on the
// surface itself lie on it, and their mean beside it, by 0.6 mm for a side of 0.1 m on a cylinder
// with a radius of 2 m. Beyond the border, the mesh continues with the bend that it has there.
MeshFoot ProjectMarker(const MeshDistance& mesh, const ShapeMarker& whole_marker);

}  // namespace velamap
