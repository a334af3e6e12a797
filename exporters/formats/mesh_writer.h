// Triangle meshes as PLY, OBJ and STL. PLY is in m, as all PLY files of velamap, so that it lies on
// the markers of shape.ply; OBJ and STL are for CAD programs and in mm, as STEP and IGES. Each says
// its unit in its header. `name` goes there too (of the part; line breaks become spaces).

#pragma once

#include <iosfwd>
#include <string>

#include "exporters/formats/mesh_triangles.h"

namespace velamap {

// Binary little-endian: double x y z, float nx ny nz, float s t (u and v of the surface), faces
// with vertex_indices. What the mesh does not have is left out.
void WriteMeshPly(const TriangleMesh& mesh, const std::string& name, std::ostream& out);

void WriteMeshObj(const TriangleMesh& mesh, const std::string& name, std::ostream& out);

// Binary STL: float coordinates and the normals of the triangles.
void WriteMeshStl(const TriangleMesh& mesh, const std::string& name, std::ostream& out);

}  // namespace velamap
