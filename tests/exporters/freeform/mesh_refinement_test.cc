#include "exporters/freeform/mesh_refinement.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

TriangleMesh OneTriangle() {
  TriangleMesh mesh;
  mesh.vertices_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals.assign(3, Eigen::Vector3d::UnitZ());
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

SurfacePoint OnThePlane(const Eigen::Vector3d& x, double) { return {x, Eigen::Vector3d::UnitZ()}; }

TEST(RefineMesh, EndsWhereEveryEdgeIsShortEnough) {
  const EdgeMeasure measure = [](const TriangleMesh& mesh, int a, int b) {
    return (mesh.vertices_m[a] - mesh.vertices_m[b]).norm() / 0.02;
  };
  const TriangleMesh mesh = RefineMesh(OneTriangle(), measure, OnThePlane, 1000000, 1);
  EXPECT_GT(mesh.triangles.size(), 2500u);
  for (const auto& [a, b, c] : mesh.triangles) {
    EXPECT_LE(measure(mesh, a, b), 1.0);
    EXPECT_LE(measure(mesh, b, c), 1.0);
    EXPECT_LE(measure(mesh, c, a), 1.0);
  }
}

// As where the normals jump at a point: no edge that ends there is ever short enough.
TEST(RefineMesh, GivesUpSoonWhereDividingDoesNotHelp) {
  const EdgeMeasure measure = [](const TriangleMesh&, int a, int b) {
    return std::min(a, b) == 0 ? 3.0 : 0.5;
  };
  int num_points = 0;
  const NearSurface near_surface = [&](const Eigen::Vector3d& x, double reach_m) {
    ++num_points;
    return OnThePlane(x, reach_m);
  };
  EXPECT_THROW(RefineMesh(OneTriangle(), measure, near_surface, 1000000, 1), DataError);
  EXPECT_LT(num_points, 100);
}

}  // namespace
}  // namespace velamap
