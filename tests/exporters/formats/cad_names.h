// Reads named curves and points of a STEP or IGES file with Open CASCADE, as CAD programs do.

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

// Entities without a name are left out. Throws std::runtime_error for a file that cannot be read.
CadNames ReadCadNames(const std::filesystem::path& path);

}  // namespace velamap
