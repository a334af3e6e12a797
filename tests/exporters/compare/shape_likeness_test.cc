#include "exporters/compare/shape_likeness.h"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/compare/shape_deviation.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;

MarkerShape Scaled(double factor, MarkerShape shape) {
  for (ShapeMarker& marker : shape.markers) {
    for (auto& x : marker.x_in_shape_m) *x *= factor;
  }
  return shape;
}

// The markers of the boat somewhere else in a box of this size, as those of another object are.
MarkerShape Scattered(double box_m, double side_m) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-box_m / 2, box_m / 2);
  MarkerShape shape = BoatShape();
  for (ShapeMarker& marker : shape.markers) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    const std::string part = marker.part;
    marker = SquareMarker(marker.marker_id, side_m, {Eigen::Quaterniond::Identity(), {x, y, z}});
    marker.part = part;
  }
  return shape;
}

// The sail turned about its luff, as by easing the sheet.
MarkerShape Eased(double angle_rad) {
  const MarkerShape boat = BoatShape();
  const Rigid3 turn{Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ())),
                    Eigen::Vector3d::Zero()};
  MarkerShape eased = Moved(turn, boat);
  for (std::size_t i = 0; i < boat.markers.size(); ++i) {
    if (boat.markers[i].part == "hull") eased.markers[i] = boat.markers[i];
  }
  return eased;
}

TEST(ShapeLikeness, OfAShapeMovedAndScaledIsItsScale) {
  const ShapeLikeness likeness =
      MeasureLikeness(Scaled(1.02, Moved(FarPose(), BoatShape())), BoatShape(), BoatLayout())
          .value();
  EXPECT_NEAR(likeness.scale, 1.02, 1e-9);
  EXPECT_LT(likeness.distance_m, 1e-9);
  EXPECT_LT(likeness.misfit, 1e-9);
  EXPECT_FALSE(DoubtOf(likeness).has_value());
}

TEST(ShapeLikeness, TrimsAreOfOneObject) {
  const MarkerShape boat = BoatShape();
  MarkerShape other_tack = boat;
  for (ShapeMarker& marker : other_tack.markers) {
    for (auto& x : marker.x_in_shape_m) x->y() *= -1;
  }
  for (const MarkerShape& trimmed : {other_tack, Eased(0.3), Eased(1.5)}) {
    for (const Layout& layout : {BoatLayout(), Layout()}) {  // without one by the shape's parts
      const auto likeness = MeasureLikeness(trimmed, boat, layout);
      ASSERT_TRUE(likeness.has_value());
      EXPECT_FALSE(DoubtOf(*likeness).has_value()) << likeness->misfit;
    }
  }
}

TEST(ShapeLikeness, ShapesOfDifferentObjectsAreBad) {
  for (const double box_m : {0.05, 5.0}) {
    const MarkerShape other = Scattered(box_m, box_m / 20);
    for (const bool is_reference : {false, true}) {
      const auto likeness = is_reference ? MeasureLikeness(BoatShape(), other, BoatLayout())
                                         : MeasureLikeness(other, BoatShape(), BoatLayout());
      ASSERT_TRUE(likeness.has_value());
      const auto doubt = DoubtOf(*likeness);
      ASSERT_TRUE(doubt.has_value()) << likeness->misfit;
      EXPECT_TRUE(doubt->is_bad);
      EXPECT_THAT(doubt->reason, HasSubstr("not of the same object"));
    }
  }
}

TEST(ShapeLikeness, AnotherSizeIsToBeChecked) {
  const auto doubt =
      DoubtOf(MeasureLikeness(Scaled(1.25, BoatShape()), BoatShape(), BoatLayout()).value());
  ASSERT_TRUE(doubt.has_value());
  EXPECT_FALSE(doubt->is_bad);
  EXPECT_THAT(doubt->reason, HasSubstr("1.25 times as large"));
  EXPECT_THAT(doubt->reason, HasSubstr("marker_length"));
}

TEST(ShapeLikeness, OfAFewMarkersIsUnknown) {
  std::set<int> all_but_two = IdsOf("sail");
  for (const int id : {120, 121, 122, 123}) all_but_two.insert(id);
  const MarkerShape two = Without(all_but_two, BoatShape());
  ASSERT_EQ(two.markers.size(), 2u);
  EXPECT_FALSE(MeasureLikeness(two, BoatShape(), BoatLayout()).has_value());
  // Three markers of different parts count together.
  all_but_two.erase(11);
  const MarkerShape three = Without(all_but_two, BoatShape());
  EXPECT_TRUE(MeasureLikeness(three, BoatShape(), BoatLayout()).has_value());
}

TEST(ShapeLikeness, ASurfaceOfAnotherObjectIsBad) {
  AlignmentOptions best_fit;
  best_fit.method = AlignmentMethod::kBestFit;
  const auto doubt_of = [&](const TriangleMesh& mesh) {
    return CompareWithMesh(Exact(MarkersOnPart(BentBoatShape(), {}, "sail")), MeshDistance(mesh),
                           {}, best_fit)
        .doubt;
  };
  EXPECT_FALSE(doubt_of(SailMesh()).has_value());
  EXPECT_TRUE(doubt_of(SphereMesh(0.1, 20)).has_value());
  const auto far = DoubtOfSurfaceFit(BoatShape(), 1.5, 36, 36);
  ASSERT_TRUE(far.has_value());
  EXPECT_TRUE(far->is_bad);
  EXPECT_THAT(far->reason, HasSubstr("not a surface of this object"));
  const auto few = DoubtOfSurfaceFit(BoatShape(), 0.01, 8, 36);
  ASSERT_TRUE(few.has_value());
  EXPECT_FALSE(few->is_bad);
  EXPECT_THAT(few->reason, HasSubstr("8 of 36 markers lie over the surface"));
  EXPECT_FALSE(DoubtOfSurfaceFit(BoatShape(), 0.01, 20, 36).has_value());
}

TEST(ShapeLikeness, ASingleMarkerIsComparedWithItsOwnSize) {
  std::set<int> others;
  for (const ShapeMarker& marker : BoatShape().markers) others.insert(marker.marker_id);
  others.erase(11);
  const MarkerShape one = Without(others, BoatShape());
  ASSERT_EQ(one.markers.size(), 1u);
  EXPECT_FALSE(DoubtOfSurfaceFit(one, 0.001, 1, 1).has_value());
  const auto far = DoubtOfSurfaceFit(one, 1.5, 1, 1);
  ASSERT_TRUE(far.has_value());
  EXPECT_THAT(far->reason, Not(HasSubstr("inf")));
}

TEST(ShapeLikeness, MillimetresAreAThousandTimesAsMany) {
  for (const double ratio : {1000.0, 1050.0, 950.0}) EXPECT_TRUE(IsThousandfold(ratio));
  for (const double ratio : {1.0, 0.001, 100.0, 1100.0}) EXPECT_FALSE(IsThousandfold(ratio));
}

}  // namespace
}  // namespace velamap
