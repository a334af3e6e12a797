#pragma once

#include <Eigen/Geometry>

#include "exporters/formats/mesh_triangles.h"

namespace velamap {

// Sum of the areas of the triangles, m^2.
inline double Area(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& x = mesh.vertices_m;
    area += (x[b] - x[a]).cross(x[c] - x[a]).norm() / 2;
  }
  return area;
}

}  // namespace velamap
