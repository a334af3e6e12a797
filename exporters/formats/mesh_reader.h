// Reads a design or a measured surface as triangles, whatever file it comes in: PLY, STL and OBJ
// through Assimp, STEP and IGES through Open CASCADE (cad_reader.h).

#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "exporters/formats/mesh_triangles.h"

namespace velamap {

struct MeshReadOptions {
  // Of PLY, STL and OBJ, which do not say their unit. Nothing: DefaultMPerUnit().
  std::optional<double> m_per_unit;
  double chord_deviation_mm = 0.1;  // of the triangles from the faces of STEP and IGES
};

// Whether ReadMesh() knows the extension: .ply .stl .obj .step .stp .iges .igs, in any case.
bool IsMeshPath(const std::filesystem::path& path);

// Whether the file says its own unit: STEP and IGES.
bool HasOwnUnit(const std::filesystem::path& path);

// As velamap itself writes them: PLY in m, STL and OBJ in mm.
double DefaultMPerUnit(const std::filesystem::path& path);

// 1 for "m", 0.001 for "mm". Throws InputError that names `what` for any other.
double MPerUnitFromName(const std::string& name, const std::string& what);

// Polygons are cut into triangles; points and lines are passed over, normals and colours too.
// Throws InputError that names the file: missing, another extension, unreadable, without triangles,
// with a coordinate that is no number.
TriangleMesh ReadMesh(const std::filesystem::path& path, const MeshReadOptions& options = {});

}  // namespace velamap
