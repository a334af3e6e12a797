// Reads the faces of a STEP or IGES file, of velamap or a design, as triangles.

#pragma once

#include <filesystem>

#include "exporters/formats/mesh_triangles.h"

namespace velamap {

// Reads .step, .stp, .iges and .igs files (extensions in upper or lower case) and converts their
// unit. The mesh has no normals; its triangles have the orientation of their face. Throws
// InputError naming the file if it is cut off, cannot be read, or has no faces. Open CASCADE
// crashes on some bad files: ReadMesh() calls this in a child process.
TriangleMesh ReadCad(const std::filesystem::path& path, double chord_deviation_mm);

}  // namespace velamap
