// Reads faces, named curves and named points of a STEP or IGES file with Open CASCADE, as CAD
// programs do.

#pragma once

#include <filesystem>
#include <map>
#include <string>

#include <Eigen/Core>

namespace velamap {

struct CadNames {
  std::map<std::string, Eigen::Vector3d> curves;  // the middle of the parameters, m
  std::map<std::string, Eigen::Vector3d> points;  // m
};

struct CadFaces {
  std::string length_unit;  // as the file names it: MM, millimetre, INCH, metre ...
  int num_faces = 0;
  double area_m2 = 0.0;  // of the exact faces, and their bounds
  Eigen::Vector3d min_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d max_m = Eigen::Vector3d::Zero();
};

// Throws std::runtime_error for a file that cannot be read.
CadFaces ReadCadFaces(const std::filesystem::path& path);

// Entities without a name are left out. Throws std::runtime_error for a file that cannot be read.
CadNames ReadCadNames(const std::filesystem::path& path);

}  // namespace velamap
