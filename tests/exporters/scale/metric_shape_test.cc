#include "exporters/scale/metric_shape.h"

#include <gtest/gtest.h>

#include "reconstruct/model/reprojection.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

TEST(MetricShape, ScalingKeepsOriginAxesAndReprojection) {
  Model model = ExampleModel();
  AddImageNoise(0.5, 1, &model);
  Model metric_model = model;
  ScaleEstimate scale;
  scale.m_per_unit = 2.5;
  ScaleModel(scale, &metric_model);
  for (const auto& [id, point] : model.points3D) {
    EXPECT_NEAR((metric_model.points3D.at(id).x_in_world - 2.5 * point.x_in_world).norm(), 0,
                1e-14);
  }
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    const Rigid3& before = model.images[i].cam_from_world;
    const Rigid3& after = metric_model.images[i].cam_from_world;
    EXPECT_LT(AngularDistance(after, before), 1e-7);
    EXPECT_NEAR((after.translation - 2.5 * before.translation).norm(), 0, 1e-13);
  }
  const auto errors_before = ComputeReprojectionErrors(model);
  const auto errors_after = ComputeReprojectionErrors(metric_model);
  ASSERT_EQ(errors_after.size(), errors_before.size());
  for (std::size_t i = 0; i < errors_before.size(); ++i) {
    EXPECT_NEAR(errors_after[i].error_px, errors_before[i].error_px, 1e-9);
  }
}

TEST(MetricShape, HoldsCornersCentresPartsAndFrames) {
  const Model model = ExampleModel();
  const MarkerShape shape = ShapeFromModel(model, ExampleLayout());
  ASSERT_EQ(shape.markers.size(), 8u);
  int previous_id = -1;
  for (const ShapeMarker& marker : shape.markers) {
    EXPECT_GT(marker.marker_id, previous_id);
    previous_id = marker.marker_id;
    ASSERT_TRUE(marker.IsWhole());
    EXPECT_EQ(marker.part, marker.marker_id < 100 ? "sail" : "hull");
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const auto& point = model.points3D.at(Point3DIdFromCorner({marker.marker_id, corner}));
      EXPECT_EQ(*marker.x_in_shape_m[corner], point.x_in_world);
      EXPECT_EQ(marker.num_frames[corner], 3);
      sum += point.x_in_world;
    }
    EXPECT_NEAR((*marker.x_in_shape_m[0] - sum / 4).norm(), 0, 1e-15);
    for (const auto& sigma_m : marker.sigma_m) EXPECT_FALSE(sigma_m);
  }
}

TEST(MetricShape, NormalsLookAtTheCameras) {
  const Model model = ExampleModel();
  for (const ShapeMarker& marker : ShapeFromModel(model, ExampleLayout()).markers) {
    for (const ModelImage& image : model.images) {
      const Eigen::Vector3d cam_in_world = Inverse(image.cam_from_world).translation;
      EXPECT_GT(MarkerNormal(marker).dot(cam_in_world - *marker.x_in_shape_m[0]), 0);
    }
  }
}

TEST(MetricShape, AMissingCornerTakesTheCentreWithIt) {
  Model model = ExampleModel();
  model.points3D.erase(Point3DIdFromCorner({2, 3}));
  const MarkerShape shape = ShapeFromModel(model, ExampleLayout());
  const ShapeMarker& marker = shape.markers.at(1);
  ASSERT_EQ(marker.marker_id, 2);
  EXPECT_FALSE(marker.IsWhole());
  EXPECT_FALSE(marker.x_in_shape_m[3]);
  EXPECT_TRUE(marker.x_in_shape_m[1] && marker.x_in_shape_m[2] && marker.x_in_shape_m[4]);
  EXPECT_EQ(marker.num_frames[0], 0);
}

TEST(MetricShape, FramesAreCountedOnceAndTheCentreHasTheFewest) {
  Model model = ExampleModel();
  auto& track = model.points3D.at(Point3DIdFromCorner({1, 4})).track;
  track.pop_back();
  track.push_back(track.front());
  const ShapeMarker marker = ShapeFromModel(model, ExampleLayout()).markers.at(0);
  EXPECT_EQ(marker.num_frames[4], 2);
  EXPECT_EQ(marker.num_frames[3], 3);
  EXPECT_EQ(marker.num_frames[0], 2);
}

TEST(MetricShape, PointsThatAreNoCornersAreLeftOut) {
  Model model = ExampleModel();
  for (const Point3DId id : {0, 5, 19, 10 * (kMaxMarkerId + 1) + 1}) model.points3D[id] = {};
  EXPECT_EQ(ShapeFromModel(model, ExampleLayout()).markers.size(), 8u);
}

TEST(MetricShape, AMarkerThatTheLayoutDoesNotNameHasNoPart) {
  const MarkerShape shape = ShapeFromModel(ExampleModel(), MakeLayout("DICT_4X4_250", 0.1));
  ASSERT_EQ(shape.markers.size(), 8u);
  EXPECT_EQ(shape.markers[0].part, "");
}

TEST(MetricShape, IsThatOfItsModelInTheSameFrameOnly) {
  const Model model = ExampleModel();
  const MarkerShape shape = ShapeFromModel(model, ExampleLayout());
  EXPECT_TRUE(IsShapeOf(shape, model));
  Model moved = model;
  moved.points3D.at(1213).x_in_world.z() += 2e-6;
  EXPECT_FALSE(IsShapeOf(shape, moved));
  Model incomplete = model;
  incomplete.points3D.erase(11);
  EXPECT_FALSE(IsShapeOf(shape, incomplete));
  EXPECT_TRUE(IsShapeOf(ShapeFromModel(incomplete, ExampleLayout()), model));
}

}  // namespace
}  // namespace velamap
