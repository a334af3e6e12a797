#include "exporters/part_planes.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

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
  for (const PartPlane& plane : planes) EXPECT_LT(plane.residual_mm.rms, 1e-10);
  const auto pairs = ComparePlanes(planes);  // back-front, back-side, front-side
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_NEAR(pairs[0].angle_deg, 180, 1e-5);
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
  EXPECT_NEAR(planes[1].residual_mm.max, 1.0, 1e-6);
  EXPECT_NEAR(planes[1].residual_mm.rms, std::sqrt(4.0 / 36), 1e-6);
}

TEST(PartPlanes, MarkersThatAreNotWholeTakeNoPart) {
  MarkerShape shape = Box();
  for (std::size_t i = 1; i < 9; ++i) shape.markers[i].x_in_shape_m[0].reset();
  EXPECT_EQ(FitPartPlanes(shape).size(), 2u);
}

TEST(PartPlanes, PrintedLinesNamePartsAndUnits) {
  std::ostringstream out;
  PrintPlanes(FitPartPlanes(Box()), out);
  EXPECT_THAT(out.str(), testing::HasSubstr("plane front: 9 markers, residual 0.0000 mm rms"));
  EXPECT_THAT(out.str(),
              testing::HasSubstr("planes back and front: 180.000 degrees, 200.000 mm apart"));
}

}  // namespace
}  // namespace velamap
