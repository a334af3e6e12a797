#include "reconstruct/colmap/warm_start.h"

#include <gtest/gtest.h>

#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/reprojection.h"
#include "reconstruct/seed_model.h"
#include "reconstruct/thesis/thesis_registration.h"
#include "tests/reconstruct/registration_fixture.h"

namespace velamap {
namespace {

class WarmStartTest : public testing::Test {
 protected:
  WarmStartTest() {
    SyntheticSceneOptions options;
    options.num_frames = 60;
    scene_ = MakeSyntheticScene(options);
    AddNoise({0.2, 0.05, 0.005, 200, 3}, &scene_);
    images_ = DatabaseImages(scene_);
    cameras_ = SceneCameras(scene_);
    posed_ = PoseImages(images_, cameras_, scene_.layout);
  }

  Registration Register(int central_frame) const {
    RegistrationOptions options;
    options.method = RegistrationMethod::kThesis;
    options.thesis.num_frames = 6;
    options.thesis.skip = 4;
    options.thesis.neighborhood = 1;
    options.central_frame = std::to_string(central_frame);
    return RegisterAroundCentralFrame(posed_, scene_.layout, options);
  }

  Model Seed(int central_frame) const {
    return MakeSeedModel(Register(central_frame), images_, cameras_);
  }

  MarkerAdjustmentSummary Adjust(Model* model) const {
    return AdjustWithMarkers({}, scene_.layout, CornerErrorsOf(images_), model);
  }

  static double Error(const Model& model) { return SummarizeReprojectionErrors(model).median; }

  SyntheticScene scene_;
  std::vector<DatabaseImage> images_;
  std::map<CameraId, Camera> cameras_;
  PosedImages posed_;
};

TEST_F(WarmStartTest, EndsWhereAColdStartEndsInFewerIterations) {
  Model neighbor = Seed(27);
  Adjust(&neighbor);
  const Model seed = Seed(30);
  Model cold = seed, warm = seed;
  const WarmStart start = StartFromAdjusted(neighbor, &warm);
  EXPECT_GT(start.num_points, static_cast<int>(seed.points3D.size()) / 2);
  EXPECT_GT(start.num_images, 0);
  EXPECT_LT(start.num_images, static_cast<int>(seed.images.size()));  // some had to be resected
  EXPECT_LT(Error(warm), 0.5 * Error(seed));
  const MarkerAdjustmentSummary of_cold = Adjust(&cold), of_warm = Adjust(&warm);
  EXPECT_LT(of_warm.num_iterations, of_cold.num_iterations);
  EXPECT_EQ(of_warm.removed.size(), of_cold.removed.size());
  ASSERT_EQ(warm.images.size(), cold.images.size());
  for (std::size_t i = 0; i < cold.images.size(); ++i) {
    EXPECT_EQ(warm.images[i].name, cold.images[i].name);
  }
  ASSERT_EQ(warm.points3D.size(), cold.points3D.size());
  for (const auto& [point3D_id, point] : cold.points3D) {
    EXPECT_LT((warm.points3D.at(point3D_id).x_in_world - point.x_in_world).norm(), 1e-5)
        << point3D_id;
    EXPECT_EQ(warm.points3D.at(point3D_id).track.size(), point.track.size());
  }
}

TEST_F(WarmStartTest, WorldFrameOfTheNeighbourDoesNotMatter) {
  Model neighbor = Seed(27);
  Adjust(&neighbor);
  Model moved = neighbor;
  TransformModel({7.0, Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {1, -2, 3}}, &moved);
  Model a = Seed(30), b = a;
  StartFromAdjusted(neighbor, &a);
  StartFromAdjusted(moved, &b);
  for (std::size_t i = 0; i < a.images.size(); ++i) {
    const Rigid3 &pose_a = a.images[i].cam_from_world, &pose_b = b.images[i].cam_from_world;
    EXPECT_LT(AngularDistance(pose_a, pose_b), 1e-6);
    EXPECT_LT((pose_a.translation - pose_b.translation).norm(), 1e-6);
  }
  CheckModel(a);
}

TEST_F(WarmStartTest, NeighbourWithLittleInCommonChangesNothing) {
  Model neighbor = Seed(27);
  const Model seed = Seed(30);
  while (2 * neighbor.points3D.size() >= seed.points3D.size()) {
    neighbor.points3D.erase(neighbor.points3D.begin());
  }
  Model warm = seed;
  EXPECT_EQ(StartFromAdjusted(neighbor, &warm).num_points, 0);
  for (std::size_t i = 0; i < seed.images.size(); ++i) {
    EXPECT_EQ(warm.images[i].cam_from_world.translation, seed.images[i].cam_from_world.translation);
  }
  for (const auto& [point3D_id, point] : seed.points3D) {
    EXPECT_EQ(warm.points3D.at(point3D_id).x_in_world, point.x_in_world);
  }
}

TEST_F(WarmStartTest, OneRegistrationLeavesNothingToTheNext) {
  const Registration first = Register(30);
  Register(20);
  const Registration again = Register(30);
  ASSERT_EQ(again.shape.size(), first.shape.size());
  for (const auto& [marker_id, points] : first.shape) {
    EXPECT_EQ(again.shape.at(marker_id), points) << marker_id;
  }
}

}  // namespace
}  // namespace velamap
