#include "reconstruct/model/turned_model.h"

#include <gtest/gtest.h>

#include "reconstruct/model/reprojection.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

// Every second image as the same picture, turned clockwise.
Model HalfTurned(int quarter_turns) {
  SyntheticSceneOptions options;
  options.num_frames = 8;
  Model model = MakeSceneModel(MakeSyntheticScene(options));
  const CameraId upright_id = model.images.front().camera_id;
  const CameraId turned_id = upright_id + 1;
  TurnedCameras turned;
  turned.cameras[turned_id] = {upright_id, quarter_turns};
  for (std::size_t i = 1; i < model.images.size(); i += 2) {
    turned.camera_of_image[model.images[i].image_id] = turned_id;
  }
  UntieTurnedCameras(turned, &model);
  return model;
}

TEST(TurnedModel, TurningAnImageKeepsItsErrors) {
  for (const int quarter_turns : {1, 3}) {
    const Model model = HalfTurned(quarter_turns);
    EXPECT_EQ(model.cameras.size(), 2u);
    EXPECT_LT(SummarizeReprojectionErrors(model).max, 1e-8);
  }
}

TEST(TurnedModel, TiesWhatBelongsTogetherAndUntiesIt) {
  for (const int quarter_turns : {1, 3}) {
    const Model before = HalfTurned(quarter_turns);
    Model model = before;
    const TurnedCameras turned = TieTurnedCameras(&model);
    EXPECT_EQ(model.cameras.size(), 1u);
    ASSERT_TRUE(turned.Any());
    EXPECT_EQ(turned.cameras.begin()->second.quarter_turns, quarter_turns);
    EXPECT_LT(SummarizeReprojectionErrors(model).max, 1e-8);
    UntieTurnedCameras(turned, &model);
    ASSERT_EQ(model.images.size(), before.images.size());
    for (std::size_t i = 0; i < model.images.size(); ++i) {
      EXPECT_EQ(model.images[i].camera_id, before.images[i].camera_id);
    }
    EXPECT_LT(SummarizeReprojectionErrors(model).max, 1e-8);
  }
}

TEST(TurnedModel, TheOtherWayIsTheSameForACentralCamera) {
  Model model = HalfTurned(1);
  for (auto& [camera_id, camera] : model.cameras) {
    camera.params[2] = 0.5 * camera.width_px;
    camera.params[3] = 0.5 * camera.height_px;
    camera.params[6] = camera.params[7] = 0.0;
  }
  const double before_px = SummarizeReprojectionErrors(model).mean;
  TurnedCameras turned = TieTurnedCameras(&model);
  TurnTheOtherWay(&turned, &model);
  EXPECT_EQ(turned.cameras.begin()->second.quarter_turns, 3);
  UntieTurnedCameras(turned, &model);
  EXPECT_NEAR(SummarizeReprojectionErrors(model).mean, before_px, 1e-8);
}

TEST(TurnedModel, LeavesOtherCamerasAlone) {
  Model model = HalfTurned(1);
  model.cameras.rbegin()->second.params[0] *= 1.001;
  EXPECT_FALSE(TieTurnedCameras(&model).Any());
  EXPECT_EQ(model.cameras.size(), 2u);
}

}  // namespace
}  // namespace velamap
