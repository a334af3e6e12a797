// Reads a design or a measured surface as triangles: PLY, STL and OBJ with Assimp, STEP and IGES
// with Open CASCADE (cad_reader.h).

#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "exporters/formats/mesh_triangles.h"

namespace velamap {

struct MeshReadOptions {
  // Unit of PLY, STL and OBJ files, which do not name it; DefaultMPerUnit() by default.
  std::optional<double> m_per_unit;
  double chord_deviation_mm = 0.1;  // distance of the triangles from the faces of STEP and IGES
};

// Whether ReadMesh() knows the extension: .ply .stl .obj .step .stp .iges .igs, in any case.
bool IsMeshPath(const std::filesystem::path& path);

// Whether the format names its unit: STEP and IGES.
bool HasOwnUnit(const std::filesystem::path& path);

// The units in which velamap writes: PLY in m, STL and OBJ in mm.
double DefaultMPerUnit(const std::filesystem::path& path);

// 1 for "m", 0.001 for "mm". Throws InputError naming `what` for any other name.
double MPerUnitFromName(const std::string& name, const std::string& what);

// Divides polygons into triangles and ignores points, lines, normals and colors. Throws InputError
// naming the file if it is missing, has another extension, cannot be read, has no triangles, or has
// a coordinate that is not finite.
TriangleMesh ReadMesh(const std::filesystem::path& path, const MeshReadOptions& options = {});

}  // namespace velamap
