// Reads the faces of a STEP or IGES file, of velamap or a design, as triangles.

#pragma once

#include <filesystem>
#include <string>

#include "exporters/formats/mesh_triangles.h"

namespace velamap {

struct CadShape {
  std::string length_unit;  // as the file names it: MM, millimetre, INCH, metre ...
  int num_faces = 0;
  double area_m2 = 0.0;                             // of the exact faces
  Eigen::Vector3d min_m = Eigen::Vector3d::Zero();  // bounds of the exact faces
  Eigen::Vector3d max_m = Eigen::Vector3d::Zero();
  TriangleMesh mesh;  // without normals; triangles have the orientation of their face
};

// The extension of a path with its dot, in lower case.
std::string LowerExtension(const std::filesystem::path& path);

// Reads .step, .stp, .iges and .igs files (extensions in upper or lower case) and converts their
// unit. Throws InputError naming the file if it has another extension, is cut off, cannot be read,
// or has no faces. Open CASCADE crashes on some bad files: ReadMesh() calls this in a child
// process.
CadShape ReadCad(const std::filesystem::path& path, double chord_deviation_mm);

}  // namespace velamap
