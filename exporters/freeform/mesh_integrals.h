// Area, volume and mean sigma of a mesh of triangles.

#pragma once

#include "exporters/formats/mesh_triangles.h"

namespace velamap {

double AreaOf(const TriangleMesh& mesh);  // m^2

// Of a closed mesh, m^3; positive even if its triangles face inwards.
double VolumeOf(const TriangleMesh& mesh);

// The root mean square over the area of the vertices' sigmas, m.
double RmsSigma(const TriangleMesh& mesh);

}  // namespace velamap
