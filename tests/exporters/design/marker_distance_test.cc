#include "exporters/design/marker_distance.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "importer/geometry/units.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

constexpr double kRadius_m = 1.0, kSide_m = 0.1;

// A cylinder about z from 0 to `end_rad`, with outward normals.
TriangleMesh CylinderMesh(double end_rad) {
  return GridMesh(200, 10, [&](double u, double v) {
    const double angle = end_rad * u;
    return Eigen::Vector3d(kRadius_m * std::cos(angle), kRadius_m * std::sin(angle), 2 * v - 1);
  });
}

// A marker whose corners are at `radius_m` from the axis of the cylinder, turned by `turn_rad` in
// its plane.
ShapeMarker MarkerOnCylinder(double angle_rad, double radius_m, double turn_rad) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()));
  ShapeMarker marker = SquareMarker(1, kSide_m, {turn, Eigen::Vector3d::Zero()});
  for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
    Eigen::Vector3d& x = *marker.x_in_shape_m[corner];
    const double angle = angle_rad + x.x() / radius_m;
    x = Eigen::Vector3d(radius_m * std::cos(angle), radius_m * std::sin(angle), x.y());
  }
  marker.x_in_shape_m[0] = MeanOfCorners(marker);
  return marker;
}

TEST(MarkerDistance, OfAMarkerOnACylinderIsThatOfItsCorners) {
  const MeshDistance mesh(CylinderMesh(2.0));
  for (const double turn_rad : {0.0, 0.4, 0.25 * kPi}) {
    for (const double offset_m : {0.0, 0.02, -0.03}) {
      const ShapeMarker marker = MarkerOnCylinder(0.9, kRadius_m + offset_m, turn_rad);
      EXPECT_NEAR(ProjectMarker(mesh, marker).distance_m, offset_m, 1e-4);
      // The centre lies side^2 / (8 radius) within, whichever way the marker is turned.
      EXPECT_NEAR(mesh.Project(*marker.x_in_shape_m[0]).distance_m, offset_m - 1.25e-3, 1e-4);
    }
  }
}

// Half of the corners have no surface below them.
TEST(MarkerDistance, AtTheBorderTheSurfaceContinuesWithItsBend) {
  const double end_rad = 1.5;
  const MeshDistance mesh(CylinderMesh(end_rad));
  for (const double turn_rad : {0.0, 0.25 * kPi}) {
    for (const double beyond_m : {-0.03, 0.0, 0.015}) {
      const ShapeMarker marker =
          MarkerOnCylinder(end_rad + beyond_m / kRadius_m, kRadius_m + 0.01, turn_rad);
      EXPECT_NEAR(ProjectMarker(mesh, marker).distance_m, 0.01, 2e-4) << beyond_m;
    }
  }
}

TEST(MarkerDistance, OnASphereAndBesideAPlane) {
  const MeshDistance ball(SphereMesh(kRadius_m, 150));
  ShapeMarker marker = SquareMarker(1, kSide_m, {Eigen::Quaterniond::Identity(), {0, 0, 1}});
  for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
    marker.x_in_shape_m[corner] = marker.x_in_shape_m[corner]->normalized();
  }
  marker.x_in_shape_m[0] = MeanOfCorners(marker);
  EXPECT_NEAR(ProjectMarker(ball, marker).distance_m, 0.0, 2e-4);
  const MeshDistance plane(PlaneMesh(1.0, 4));
  for (const double x_m : {0.1, 0.97, 1.2}) {
    const ShapeMarker flat =
        SquareMarker(1, kSide_m, {Eigen::Quaterniond::Identity(), {x_m, 0.98, 0.3}});
    const MeshFoot foot = ProjectMarker(plane, flat);
    EXPECT_NEAR(foot.distance_m, 0.3, 1e-7);
    EXPECT_NEAR(foot.beside_m, std::max(0.0, x_m - 1.0), 1e-9);
  }
}

// A marker near the edge of a cube does not see the faces around the corner.
TEST(MarkerDistance, NearASharpEdgeItIsThatFromItsOwnFace) {
  TriangleMesh cube;
  for (int i = 0; i < 8; ++i) cube.vertices_m.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  cube.triangles = {{4, 5, 7}, {4, 7, 6}, {0, 3, 1}, {0, 2, 3}, {0, 1, 5}, {0, 5, 4},
                    {2, 7, 3}, {2, 6, 7}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  const MeshDistance mesh(cube);
  ASSERT_EQ(mesh.NumFlippedEdges(), 0);
  for (const double height_m : {0.0, 0.004}) {
    const ShapeMarker marker =
        SquareMarker(1, kSide_m, {Eigen::Quaterniond::Identity(), {0.94, 0.06, 1.0 + height_m}});
    EXPECT_NEAR(ProjectMarker(mesh, marker).distance_m, height_m, 1e-7);
  }
}

}  // namespace
}  // namespace velamap
