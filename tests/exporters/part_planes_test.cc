#include "exporters/part_planes.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

// A 3x3 grid of markers of 2 cm on one face of a box, outward normal along `axis`.
void AddFace(const std::string& part, const Eigen::Quaterniond& rotation, double distance_m,
             int first_id, MarkerShape* shape) {
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector3d center(0.04 * (i % 3 - 1), 0.04 * (i / 3 - 1), distance_m);
    ShapeMarker marker;
    marker.marker_id = first_id + i;
    marker.part = part;
    const std::array<Eigen::Vector3d, 5> offsets = {
        {{0, 0, 0}, {-0.01, 0.01, 0}, {0.01, 0.01, 0}, {0.01, -0.01, 0}, {-0.01, -0.01, 0}}};
    for (std::size_t corner = 0; corner < 5; ++corner) {
      marker.x_in_shape_m[corner] = rotation * (center + offsets[corner]);
    }
    shape->markers.push_back(marker);
  }
}

MarkerShape Box() {
  MarkerShape shape;
  AddFace("front", Eigen::Quaterniond::Identity(), 0.1, 0, &shape);
  AddFace("back", Eigen::Quaterniond(Eigen::AngleAxisd(3.14159265358979, Eigen::Vector3d::UnitX())),
          0.1, 10, &shape);
  AddFace("side", Eigen::Quaterniond(Eigen::AngleAxisd(1.57079632679490, Eigen::Vector3d::UnitY())),
          0.1, 20, &shape);
  return shape;
}

TEST(PartPlanes, ExactBoxHasFlatFacesAtRightAngles) {
  const auto planes = FitPartPlanes(Box());
  ASSERT_EQ(planes.size(), 3u);
  for (const PartPlane& plane : planes) {
    EXPECT_EQ(plane.num_markers, 9);
    EXPECT_EQ(plane.corner_distance_mm.count, 36);
    EXPECT_EQ(plane.center_distance_mm.count, 9);
    EXPECT_LT(plane.corner_distance_mm.max, 1e-10);
    EXPECT_LT(plane.center_distance_mm.max, 1e-10);
    EXPECT_LT(plane.normal_spread_deg.max, 1e-10);
    EXPECT_LT(plane.tangent_spread_deg.max, 1e-10);
  }
  const auto pairs = ComparePlanes(planes);  // back-front, back-side, front-side
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_NEAR(pairs[0].angle_deg, 180, 1e-10);
  EXPECT_NEAR(pairs[0].distance_mm, 200, 1e-9);
  EXPECT_NEAR(pairs[1].angle_deg, 90, 1e-9);
  EXPECT_EQ(pairs[2].distance_mm, 0);
}

TEST(PartPlanes, ResidualIsTheDistanceFromThePlane) {
  MarkerShape shape = Box();
  // Lift opposite corners of the middle marker: the plane stays, four residuals appear.
  for (std::size_t corner = 1; corner <= 4; ++corner) {
    *shape.markers[4].x_in_shape_m[corner] += Eigen::Vector3d(0, 0, corner % 2 ? 1e-3 : -1e-3);
  }
  const auto planes = FitPartPlanes(shape);
  EXPECT_EQ(planes[1].part, "front");
  EXPECT_NEAR(planes[1].corner_distance_mm.max, 1.0, 1e-6);
  EXPECT_NEAR(planes[1].corner_distance_mm.rms, std::sqrt(4.0 / 36), 1e-6);
  EXPECT_LT(planes[1].center_distance_mm.max, 1e-10);  // the centre stays where it is
}

TEST(PartPlanes, MarkersThatAreNotWholeTakeNoPart) {
  MarkerShape shape = Box();
  for (std::size_t i = 1; i < 9; ++i) shape.markers[i].x_in_shape_m[0].reset();
  EXPECT_EQ(FitPartPlanes(shape).size(), 2u);
}

TEST(PartPlanes, PlaneErrorIsTheDistanceOfTheCentersWithoutSign) {
  MarkerShape shape;
  for (int i = 0; i < 4; ++i) {  // a square saddle: its plane is z = 0
    const double x = i % 2 == 0 ? -0.1 : 0.1, y = i / 2 == 0 ? -0.1 : 0.1;
    shape.markers.push_back(
        SquareMarker(i, 0.02, {Eigen::Quaterniond::Identity(), {x, y, 20.0 * x * y * 0.01}}));
  }
  const Statistics distance_mm = FitPartPlanes(shape).at(0).center_distance_mm;
  EXPECT_EQ(distance_mm.count, 4);
  EXPECT_NEAR(distance_mm.min, 2.0, 1e-9);
  EXPECT_NEAR(distance_mm.max, 2.0, 1e-9);
  shape.markers.pop_back();  // three points always lie in a plane
  EXPECT_EQ(FitPartPlanes(shape).at(0).center_distance_mm.count, 0);
  EXPECT_EQ(FitPartPlanes(shape).at(0).corner_distance_mm.count, 12);
}

// Two markers that lean a degrees to either side of their mean.
PartPlane Leaning(double angle_deg, const Eigen::Vector3d& axis) {
  MarkerShape shape;
  for (const int sign : {-1, 1}) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(sign * angle_deg * EIGEN_PI / 180, axis));
    const Eigen::Quaterniond odd(0.8, 0.3, -0.4, 0.1);
    shape.markers.push_back(
        SquareMarker(sign + 1, 0.05, {odd.normalized() * turn, {0.2 * sign, 1, 3}}));
  }
  return FitPartPlanes(shape).at(0);
}

TEST(PartPlanes, SpreadsAreTheAnglesToTheMeanDirection) {
  const PartPlane turned_in_plane = Leaning(3.0, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(turned_in_plane.tangent_spread_deg.min, 3.0, 1e-9);
  EXPECT_NEAR(turned_in_plane.tangent_spread_deg.max, 3.0, 1e-9);
  EXPECT_LT(turned_in_plane.normal_spread_deg.max, 1e-9);
  const PartPlane about_x = Leaning(1e-6, Eigen::Vector3d::UnitX());  // small angles stay exact
  EXPECT_NEAR(about_x.normal_spread_deg.mean, 1e-6, 1e-12);
  EXPECT_LT(about_x.tangent_spread_deg.max, 1e-12);
  const PartPlane about_y = Leaning(20.0, Eigen::Vector3d::UnitY());
  EXPECT_NEAR(about_y.normal_spread_deg.mean, 20.0, 1e-9);
  EXPECT_NEAR(about_y.tangent_spread_deg.mean, 20.0, 1e-9);
}

}  // namespace
}  // namespace velamap
