#include "workflows/plan/plan_surface.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"
#include "tests/workflows/plan/plan_example.h"

namespace velamap {
namespace {

TEST(PlannedSurfaceTest, MarkersAreSquaresOfTheirSizeThatFaceTheCamera) {
  const PlannedSurface surface = PlannedSail();
  EXPECT_EQ(surface.shape.markers.size(), MarkerIds(surface.layout).size());
  EXPECT_TRUE(surface.markers_left_out.empty());
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const ShapeMarker& marker : surface.shape.markers) {
    for (const double side_m : MarkerSides(marker)) EXPECT_NEAR(side_m, 0.1, 1e-12);
    EXPECT_NEAR(MarkerArea(marker), 0.01, 1e-12);
    EXPECT_LT(MarkerNormal(marker).y(), -0.5);
    EXPECT_GT((*marker.x_in_shape_m[1] - *marker.x_in_shape_m[4]).normalized().z(), 0.9);
    middle += *marker.x_in_shape_m[0];
  }
  EXPECT_LT(middle.norm(), 1e-9);
}

// The deepest place of a sail of 2 m foot lies 0.2 m behind its chord.
TEST(PlannedSurfaceTest, CamberMakesDepth) {
  const auto depth_of = [](double camber) {
    double least = 1e9, most = -1e9;
    for (const ShapeMarker& marker : PlannedSail(camber).shape.markers) {
      if (marker.part != "sail" || marker.marker_id >= 6) continue;  // the lowest line
      least = std::min(least, marker.x_in_shape_m[0]->y());
      most = std::max(most, marker.x_in_shape_m[0]->y());
    }
    return most - least;
  };
  EXPECT_GT(depth_of(0.1), depth_of(0.05) + 0.03);
}

// Wherever the frame of a shape is, the plan is the same.
TEST(PlannedSurfaceTest, ShapeIsTurnedIntoThePlanFrame) {
  const PlannedSurface planned = PlannedSail();
  MarkerShape turned = planned.shape;
  const Eigen::Quaterniond rotation(
      Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, -2, 0.5).normalized()));
  for (ShapeMarker& marker : turned.markers) {
    for (auto& x : marker.x_in_shape_m) x = rotation * *x + Eigen::Vector3d(5, 6, 7);
  }
  const PlannedSurface again = SurfaceOfShape(turned, planned.layout, "shape.csv");
  ASSERT_EQ(again.shape.markers.size(), planned.shape.markers.size());
  for (std::size_t i = 0; i < again.shape.markers.size(); ++i) {
    for (std::size_t c = 0; c <= kNumCorners; ++c) {
      EXPECT_LT(
          (*again.shape.markers[i].x_in_shape_m[c] - *planned.shape.markers[i].x_in_shape_m[c])
              .norm(),
          1e-9);
    }
  }
}

TEST(PlannedSurfaceTest, LinesOfALayoutKeepTheirIds) {
  SailPlacementOptions sail;
  sail.luff_m = 4;
  sail.foot_m = 2;
  sail.leech_m = 4.2;
  Layout layout = MakeLayout("DICT_4X4_250", 0.1);
  layout.parts = {{"main", false, {{"h1", {7, 3, 5}}, {"h2", {9, 8}}}, {}, {20}}};
  const Placement placement = PlaceLinesOnSail(sail, layout, 150);
  ASSERT_EQ(placement.horizontal.size(), 2u);
  EXPECT_EQ(placement.horizontal[0].markers[1].marker_id, 3);
  EXPECT_EQ(placement.horizontal[1].markers[0].marker_id, 9);
  const PlannedSurface surface = SurfaceOfPlacement(placement, layout, 0.1, 0);
  EXPECT_EQ(surface.markers_left_out, std::vector<int>{20});
  layout.parts[0].horizontal[1].marker_ids.assign(60, 1);
  ExpectThrows<InputError>([&] { PlaceLinesOnSail(sail, layout, 150); }, {"room"});
  layout.parts[0].horizontal.clear();
  ExpectThrows<InputError>([&] { PlaceLinesOnSail(sail, layout, 150); },
                           {"--layout_path", "lines"});
}

}  // namespace
}  // namespace velamap
