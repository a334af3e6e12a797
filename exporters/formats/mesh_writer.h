// Writes triangle meshes as PLY, OBJ and STL. PLY is in m like all PLY files of velamap, so that
// the mesh lies on the markers of shape.ply. OBJ and STL are in the unit that is asked for. The
// header names the unit and `name`, the part; line breaks in it become spaces.

#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "exporters/formats/length_unit.h"
#include "exporters/formats/mesh_triangles.h"
#include "exporters/formats/ply_writer.h"

namespace velamap {

// double x y z, float nx ny nz, float s t (u and v of the surface) and float sigma if the mesh has
// them, and faces with vertex_indices.
void WriteMeshPly(const TriangleMesh& mesh, const std::string& name, PlyFormat format,
                  std::ostream& out);

void WriteMeshObj(const TriangleMesh& mesh, const std::string& name, LengthUnit unit,
                  std::ostream& out);

// Binary STL: float coordinates and normals of the triangles.
void WriteMeshStl(const TriangleMesh& mesh, const std::string& name, LengthUnit unit,
                  std::ostream& out);

// The unit that the beginning of an OBJ or STL of velamap names; nothing for other files.
std::optional<LengthUnit> UnitOfMeshFile(const std::string& beginning);

}  // namespace velamap
