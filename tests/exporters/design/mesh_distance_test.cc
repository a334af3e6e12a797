#include "exporters/design/mesh_distance.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "importer/geometry/units.h"
#include "tests/exporters/compare/example_comparison.h"

namespace velamap {
namespace {

Eigen::Vector3d RandomPoint(std::mt19937* random, double half_m) {
  std::uniform_real_distribution<double> coordinate(-half_m, half_m);
  const double x = coordinate(*random), y = coordinate(*random), z = coordinate(*random);
  return {x, y, z};
}

// A mesh like STL, in which no triangles share vertices.
TriangleMesh Unshared(const TriangleMesh& mesh) {
  TriangleMesh result;
  for (const auto& t : mesh.triangles) {
    const int first = static_cast<int>(result.vertices_m.size());
    for (const int vertex : t) {
      result.vertices_m.push_back(mesh.vertices_m[static_cast<std::size_t>(vertex)]);
    }
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

TEST(MeshDistance, OverAPlaneIsTheHeight) {
  const MeshDistance mesh(PlaneMesh(2.0, 7));
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d x = RandomPoint(&random, 1.9);
    const MeshFoot foot = mesh.Project(x);
    EXPECT_NEAR(foot.distance_m, x.z(), 1e-12);
    EXPECT_NEAR((foot.x_m - Eigen::Vector3d(x.x(), x.y(), 0)).norm(), 0, 1e-12);
    EXPECT_TRUE(foot.normal.isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
    EXPECT_TRUE(foot.IsOverSurface(mesh.Diagonal_m()));
  }
}

TEST(MeshDistance, ToASphereIsThatToItsCentreLessTheRadius) {
  const double radius_m = 2.0;
  for (const TriangleMesh& triangles : {SphereMesh(radius_m, 60), Unshared(SphereMesh(2.0, 60))}) {
    const MeshDistance mesh(triangles);
    EXPECT_EQ(mesh.NumFlippedEdges(), 0);
    std::mt19937 random(2);
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector3d x = RandomPoint(&random, 3.0);
      const double truth_m = x.norm() - radius_m;
      const MeshFoot foot = mesh.Project(x);
      const double sagitta_m = radius_m * (1 - std::cos(kPi / 60)) * 1.5;
      EXPECT_NEAR(foot.distance_m, truth_m, sagitta_m);
      EXPECT_EQ(foot.beside_m, 0);  // it has no border, whether vertices are shared or not
      // No triangle is nearer than the foot.
      for (std::size_t k = 0; k < triangles.vertices_m.size(); k += 97) {
        EXPECT_LE(std::abs(foot.distance_m), (x - triangles.vertices_m[k]).norm() + 1e-12);
      }
    }
  }
}

// Most of these feet are on edges and vertices, whose mean normals miss the points.
TEST(MeshDistance, APointLessItsDistanceAlongTheNormalIsItsFoot) {
  std::mt19937 random(5);
  for (const TriangleMesh& triangles : {SphereMesh(2.0, 12), SailMesh()}) {
    const MeshDistance mesh(triangles);
    for (int i = 0; i < 300; ++i) {
      const Eigen::Vector3d x = RandomPoint(&random, 4.0);
      const MeshFoot foot = mesh.Project(x);
      EXPECT_NEAR(foot.normal.norm(), 1, 1e-12);
      if (foot.beside_m > 0) continue;
      EXPECT_LT((x - foot.distance_m * foot.normal - foot.x_m).norm(), 1e-9);
    }
    // On the mesh, there is a normal too.
    EXPECT_NEAR(mesh.Project(triangles.vertices_m[200]).normal.norm(), 1, 1e-12);
  }
}

// At edges and vertices, the normal of one face would give the wrong sign for half of these points.
TEST(MeshDistance, SignsAreRightAroundASharpVertex) {
  TriangleMesh spike;
  spike.vertices_m = {{0, 0, 1}, {0.1, 0, 0}, {-0.05, 0.0866, 0}, {-0.05, -0.0866, 0}};
  spike.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  const MeshDistance mesh(spike);
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    Eigen::Vector3d x = RandomPoint(&random, 0.5);
    x.z() = 1.001 + std::abs(x.z());
    EXPECT_GT(mesh.Project(x).distance_m, 0);
    EXPECT_NEAR(mesh.Project(x).distance_m, (x - spike.vertices_m[0]).norm(), 0.3);
  }
  EXPECT_LT(mesh.Project({0, 0, 0.5}).distance_m, 0);
}

TEST(MeshDistance, BesideTheBorderIsNoDistanceFromTheSurface) {
  const MeshDistance mesh(PlaneMesh(1.0, 4));
  const MeshFoot edge = mesh.Project({1.5, 0.1, 0.2});
  EXPECT_NEAR(edge.distance_m, 0.2, 1e-12);
  EXPECT_NEAR(edge.beside_m, 0.5, 1e-12);
  EXPECT_FALSE(edge.IsOverSurface(mesh.Diagonal_m()));
  const MeshFoot vertex = mesh.Project({1.3, -1.4, -0.2});
  EXPECT_NEAR(vertex.distance_m, -0.2, 1e-12);
  EXPECT_NEAR(vertex.beside_m, 0.5, 1e-12);
  EXPECT_TRUE(mesh.Project({1.0, 0.3, 0.2}).IsOverSurface(mesh.Diagonal_m()));  // on the border
}

TEST(MeshDistance, MovesWithTheMesh) {
  const Rigid3 pose = FarPose();
  TriangleMesh moved = SailMesh();
  const MeshDistance mesh(moved);
  for (Eigen::Vector3d& x : moved.vertices_m) x = pose * x;
  const MeshDistance moved_mesh(moved);
  std::mt19937 random(4);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d x = RandomPoint(&random, 3.0);
    const MeshFoot a = mesh.Project(x), b = moved_mesh.Project(pose * x);
    EXPECT_NEAR(a.distance_m, b.distance_m, 1e-9);
    EXPECT_NEAR(a.beside_m, b.beside_m, 1e-9);
  }
  EXPECT_LT((pose * mesh.Moments().mean_m - moved_mesh.Moments().mean_m).norm(), 1e-9);
}

TEST(MeshDistance, MomentsOfASquare) {
  const MeshDistance mesh(PlaneMesh(3.0, 5));
  EXPECT_LT(mesh.Moments().mean_m.norm(), 1e-12);
  // Side^2 / 12 along x and y.
  EXPECT_TRUE(mesh.Moments().covariance_m2.isApprox(
      Eigen::Vector3d(3, 3, 0).asDiagonal().toDenseMatrix(), 1e-12));
}

TEST(MeshDistance, TrianglesThatLookToOppositeSidesAreCounted) {
  TriangleMesh mesh = PlaneMesh(1.0, 3);
  std::swap(mesh.triangles[8][0], mesh.triangles[8][1]);
  EXPECT_EQ(MeshDistance(mesh).NumFlippedEdges(), 3);
}

TEST(MeshDistance, TrianglesWithoutAnAreaDoNotMatter) {
  TriangleMesh mesh = PlaneMesh(1.0, 3);
  mesh.triangles.insert(mesh.triangles.begin(), {0, 0, 1});
  EXPECT_NEAR(MeshDistance(mesh).Project({-1, -1, 0.5}).distance_m, 0.5, 1e-12);
}

}  // namespace
}  // namespace velamap
