// Reads a design or a measured surface as triangles: PLY, STL and OBJ with Assimp, STEP and IGES
// with Open CASCADE. Both crash or never end on some bad files, so they run in a child process
// (this program, started again) with limits of time and memory.

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

// Whether ReadMesh() knows the extension: .ply .stl .obj .step .stp .iges .igs, in upper or lower
// case.
bool IsMeshPath(const std::filesystem::path& path);

// Whether the format names its unit: STEP and IGES.
bool HasOwnUnit(const std::filesystem::path& path);

// 1 for PLY; for STL and OBJ the unit that files written by velamap name, else 0.001.
double DefaultMPerUnit(const std::filesystem::path& path);

// 1 for "m", 0.001 for "mm". Throws InputError naming `what` for any other name.
double MPerUnitFromName(const std::string& name, const std::string& what);

// main() of each program that calls ReadMesh() calls this first: if the program was started to read
// a mesh, it does so and ends.
void ServeMeshReader(int argc, char** argv);

// Divides polygons into triangles and ignores points, lines, normals and colours. Throws InputError
// naming the file if it is missing, has another extension, is too large (mesh_parser.h), cannot be
// read, has no triangles, has a coordinate that is not finite, or lies so far from the origin that
// PLY, STL or OBJ are read in steps above 1 mm (above 0.01 mm, it warns); also if reading it
// crashes, or takes more time or memory than MeshLimits (mesh_process.h) allow.
TriangleMesh ReadMesh(const std::filesystem::path& path, const MeshReadOptions& options = {});

}  // namespace velamap
