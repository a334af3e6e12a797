// Reads the faces of a STEP or IGES file, of velamap or a design, as triangles.

#pragma once

#include <filesystem>
#include <string>

#include "exporters/formats/mesh_triangles.h"

namespace velamap {

struct CadShape {
  std::string length_unit;  // of the file, as it names it: MM, millimetre, INCH, metre ...
  int num_faces = 0;
  double area_m2 = 0.0;                             // of the exact faces
  Eigen::Vector3d min_m = Eigen::Vector3d::Zero();  // extents of the exact faces
  Eigen::Vector3d max_m = Eigen::Vector3d::Zero();
  TriangleMesh mesh;  // without normals; its triangles look where their face does
};

// By extension: .step .stp .iges .igs, in any case. Lengths are converted from the file's unit.
// Throws InputError that names the file: another extension, unreadable, no faces.
CadShape ReadCad(const std::filesystem::path& path, double chord_deviation_mm);

}  // namespace velamap
