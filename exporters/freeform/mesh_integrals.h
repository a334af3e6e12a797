// Area, volume and RMS sigma of a triangle mesh.

#pragma once

#include "exporters/formats/mesh_triangles.h"

namespace velamap {

double AreaOf(const TriangleMesh& mesh);  // m^2

// The volume of a closed mesh, m^3. It is positive even if the triangles face inwards.
double VolumeOf(const TriangleMesh& mesh);

// The root mean square of the sigmas of the vertices, weighted by area, m. The mesh must have
// sigmas.
double RmsSigma(const TriangleMesh& mesh);

}  // namespace velamap
