#include "reconstruct/correlation/error_correlation.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/reconstruct/problem/tiny_scene.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

TEST(GroupImages, NeighboursInTimeShareAGroupWithoutLeadingZeros) {
  Model model;
  model.cameras[1] = {CameraModel::kSimplePinhole, 640, 480, {500, 320, 240}};
  for (int number = 10; number >= 1; --number) {
    ModelImage image;
    image.image_id = static_cast<ImageId>(number);
    image.camera_id = 1;
    image.name = "frame_" + std::to_string(number) + ".png";
    model.images.push_back(image);
  }
  EXPECT_EQ(GroupImages(model, kNumCorrelationGroups),
            (std::vector<int>{4, 4, 3, 3, 2, 2, 1, 1, 0, 0}));
}

// Enough images for several panels of columns.
TEST(MarkerCovariance, IsTheSameForAnyNumberOfThreads) {
  SyntheticSceneOptions scene_options;
  scene_options.num_rows = 2;
  scene_options.num_columns = 4;
  scene_options.num_frames = 30;
  SyntheticScene scene = MakeSyntheticScene(scene_options);
  AddNoise({0.2, 0, 0, 5, 1}, &scene);
  const Model model = MakeSceneModel(scene);
  MarkerState state = MakeMarkerState(model, scene.layout);
  const MarkerWeights weights = WeightsWithoutLoss();
  const MarkerProblem problem = MakeMarkerProblem({}, model, {}, model.cameras, weights, &state);
  const std::vector<int> groups = GroupImages(model, kNumCorrelationGroups);
  const MarkerJacobian jacobian = EvaluateJacobian(problem);
  const auto covariance = InvertNormalEquations(jacobian, 1);
  ASSERT_TRUE(covariance.has_value());
  const double factor = CorrelationFactor(state, problem, jacobian, *covariance, groups, 1);
  for (const int num_threads : {2, 5}) {
    const auto other = InvertNormalEquations(jacobian, num_threads);
    ASSERT_TRUE(other.has_value());
    EXPECT_EQ(other->factor, covariance->factor);
    EXPECT_EQ(other->root, covariance->root);
    EXPECT_EQ(other->marker_blocks, covariance->marker_blocks);
    EXPECT_EQ(CorrelationFactor(state, problem, jacobian, *other, groups, num_threads), factor);
  }
}

}  // namespace
}  // namespace velamap
