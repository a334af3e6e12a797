#include "exporters/freeform/mesh_integrals.h"

#include <cmath>

#include <Eigen/Geometry>

namespace velamap {

double AreaOf(const TriangleMesh& mesh) {
  double area_m2 = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& x = mesh.vertices_m;
    area_m2 += (x[b] - x[a]).cross(x[c] - x[a]).norm() / 2;
  }
  return area_m2;
}

// By the divergence theorem.
double VolumeOf(const TriangleMesh& mesh) {
  const auto& x = mesh.vertices_m;
  const Eigen::Vector3d origin = x.front();
  double volume_m3 = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    volume_m3 += (x[a] - origin).dot((x[b] - origin).cross(x[c] - origin)) / 6;
  }
  return std::abs(volume_m3);
}

double RmsSigma(const TriangleMesh& mesh) {
  double sum = 0.0, area = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& x = mesh.vertices_m;
    const auto& sigma = mesh.sigmas_m;
    const double weight = (x[b] - x[a]).cross(x[c] - x[a]).norm();
    sum += weight * (sigma[a] * sigma[a] + sigma[b] * sigma[b] + sigma[c] * sigma[c]) / 3;
    area += weight;
  }
  return std::sqrt(sum / area);
}

}  // namespace velamap
