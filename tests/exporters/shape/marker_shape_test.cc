#include "exporters/shape/marker_shape.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

TEST(MarkerShape, NormalOfTheUprightMarkerIsItsZAxis) {
  EXPECT_NEAR((MarkerNormal(SquareMarker(1, 0.1)) - Eigen::Vector3d::UnitZ()).norm(), 0, 1e-15);
}

TEST(MarkerShape, NormalTurnsWithTheMarkerAndAreaAndSidesDoNot) {
  const Rigid3 shape_from_marker{ExampleSim3(1).rotation, ExampleSim3(1).translation};
  const ShapeMarker marker = SquareMarker(1, 0.25, shape_from_marker);
  const Eigen::Vector3d expected = shape_from_marker.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR((MarkerNormal(marker) - expected).norm(), 0, 1e-13);
  EXPECT_NEAR(MarkerArea(marker), 0.0625, 1e-14);
  for (const double side : MarkerSides(marker)) EXPECT_NEAR(side, 0.25, 1e-14);
}

TEST(MarkerShape, SidesAreInTheOrderOfTheCorners) {
  ShapeMarker marker = SquareMarker(1, 2.0);
  marker.x_in_shape_m[1] = Eigen::Vector3d(-4, 1, 0);  // 3 m to the left of where it was
  const auto sides = MarkerSides(marker);
  EXPECT_DOUBLE_EQ(sides[0], 5.0);                   // 1-2
  EXPECT_DOUBLE_EQ(sides[1], 2.0);                   // 2-3
  EXPECT_DOUBLE_EQ(sides[2], 2.0);                   // 3-4
  EXPECT_DOUBLE_EQ(sides[3], std::hypot(3.0, 2.0));  // 4-1
  EXPECT_DOUBLE_EQ(MarkerArea(marker), 4.0 + 3.0);   // and a triangle of 3 by 2
}

TEST(MarkerShape, AMarkerWithoutAreaHasNoNormal) {
  ShapeMarker marker = SquareMarker(1, 0.1);
  for (auto& x : marker.x_in_shape_m) x = Eigen::Vector3d(1, 2, 3);
  EXPECT_EQ(MarkerNormal(marker), Eigen::Vector3d::Zero());
  EXPECT_EQ(MarkerArea(marker), 0.0);
}

TEST(MarkerShape, AnIncompleteMarkerIsABrokenInvariant) {
  ShapeMarker marker = SquareMarker(1, 0.1);
  marker.x_in_shape_m[0].reset();
  marker.x_in_shape_m[3].reset();
  EXPECT_FALSE(marker.IsWhole());
  EXPECT_THROW(MarkerNormal(marker), std::logic_error);
  EXPECT_THROW(MarkerArea(marker), std::logic_error);
  EXPECT_THROW(MarkerSides(marker), std::logic_error);
}

// A box of 3 x 2 x 1 m, turned: the sides do not depend on the frame.
TEST(BoundingBoxTest, SidesAreThoseOfATurnedBox) {
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  MarkerShape shape;
  for (const double z : {0.0, 1.0}) {
    ShapeMarker marker;
    marker.x_in_shape_m[0] = rotation * Eigen::Vector3d(1.5, 1, z);
    marker.x_in_shape_m[1] = rotation * Eigen::Vector3d(0, 0, z);
    marker.x_in_shape_m[2] = rotation * Eigen::Vector3d(3, 0, z);
    marker.x_in_shape_m[3] = rotation * Eigen::Vector3d(3, 2, z);
    marker.x_in_shape_m[4] = rotation * Eigen::Vector3d(0, 2, z);
    shape.markers.push_back(marker);
  }
  EXPECT_NEAR((BoundingBox(shape) - Eigen::Vector3d(3, 2, 1)).norm(), 0.0, 1e-12);
}

// All directions are principal axes of a cube; its markers know better.
TEST(BoundingBoxTest, CubeHasItsOwnSides) {
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  MarkerShape shape;
  for (const double z : {0.0, 2.0}) {
    ShapeMarker marker;
    const std::array<Eigen::Vector3d, 5> points = {
        Eigen::Vector3d(1, 1, z), Eigen::Vector3d(0, 0, z), Eigen::Vector3d(2, 0, z),
        Eigen::Vector3d(2, 2, z), Eigen::Vector3d(0, 2, z)};
    for (std::size_t i = 0; i < points.size(); ++i) marker.x_in_shape_m[i] = rotation * points[i];
    shape.markers.push_back(marker);
  }
  EXPECT_NEAR((BoundingBox(shape) - Eigen::Vector3d(2, 2, 2)).norm(), 0.0, 1e-12);
}

TEST(BoundingBoxTest, NothingHasNoSize) { EXPECT_EQ(BoundingBox({}), Eigen::Vector3d::Zero()); }

}  // namespace
}  // namespace velamap
