#include "reconstruct/camera/camera_steadiness.h"

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "importer/base/statistics.h"
#include "reconstruct/model/reprojection.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

using testing::HasSubstr;

// The images are taken with another camera each, and the model has the first one for all.
Model SceneWith(const std::function<void(int frame_idx, Camera* camera)>& change) {
  SyntheticSceneOptions options;
  options.num_frames = 20;
  SyntheticScene scene = MakeSyntheticScene(options);
  AddNoise({0.1, 0, 0, 200, 7}, &scene);
  for (int i = 0; i < options.num_frames; ++i) {
    Camera camera = scene.camera;
    change(i, &camera);
    const Rigid3& pose = scene.cam_from_world[static_cast<std::size_t>(i)];
    for (MarkerDetection& marker : scene.frames[static_cast<std::size_t>(i)].markers) {
      for (std::size_t c = 0; c < kNumCorners; ++c) {
        const Eigen::Vector3d x = pose * scene.x_in_world.at(marker.marker_id)[c + 1];
        marker.corners_in_image_px[c] += *ImageFromCam(camera, x) - *ImageFromCam(scene.camera, x);
      }
    }
  }
  Model model = MakeSceneModel(scene);
  UpdatePointErrors(&model);
  return model;
}

TEST(CameraSteadiness, OneCameraIsSteady) {
  const Model model = SceneWith([](int, Camera*) {});
  const SteadinessVerdict verdict = JudgeSteadiness(model);
  EXPECT_FALSE(verdict.step && verdict.step->IsSuspicious());
  EXPECT_FALSE(verdict.wander);
  double sum = 0.0;
  const auto values = IntrinsicsOfImages(model);
  ASSERT_EQ(values.size(), 20u);
  for (const ImageIntrinsics& value : values) {
    sum += std::pow(value.log_focal / value.log_focal_sigma, 2);
  }
  EXPECT_GT(sum / 20, 0.3);
  EXPECT_LT(sum / 20, 2.4);
}

TEST(CameraSteadiness, AZoomIsFoundWhereItBegins) {
  const auto verdict = JudgeSteadiness(SceneWith([](int frame_idx, Camera* camera) {
    if (frame_idx < 12) return;
    camera->params[0] *= 1.06;
    camera->params[1] *= 1.06;
  }));
  ASSERT_TRUE(verdict.step);
  EXPECT_TRUE(verdict.step->IsCertain());
  EXPECT_TRUE(verdict.step->SpoilsShape());
  EXPECT_NEAR(verdict.step->after_px / verdict.step->before_px, 1.06, 0.01);
  EXPECT_THAT(DescribeStep(*verdict.step),
              HasSubstr("about frame_000012.jpg: the lens was zoomed"));
}

void Zoom(double zoom, Camera* camera) {
  camera->params[0] *= zoom;
  camera->params[1] *= zoom;
}

TEST(CameraSteadiness, TwoLensesThatAlternateAreFound) {
  const auto verdict = JudgeSteadiness(SceneWith([](int frame_idx, Camera* camera) {
    if (frame_idx % 2 == 1) Zoom(1.06, camera);
  }));
  ASSERT_TRUE(verdict.step);
  EXPECT_FALSE(verdict.step->IsInTime());
  EXPECT_TRUE(verdict.step->IsCertain());
  EXPECT_NEAR(verdict.step->after_px / verdict.step->before_px, 1.06, 0.01);
  EXPECT_EQ(verdict.step->image_ids_before.size(), 10u);
  EXPECT_THAT(DescribeStep(*verdict.step),
              HasSubstr("10 of the pictures, frame_000001.jpg the first of them, have a focal"));
}

// Any scatter falls into two groups, but not into groups that are far apart.
TEST(CameraSteadiness, AFocusThatBreathesIsNoSecondLens) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const double amplitude : {0.005, 0.02}) {
    const auto slow = JudgeSteadiness(SceneWith([=](int frame_idx, Camera* camera) {
      Zoom(1 + amplitude * std::sin(0.9 * frame_idx), camera);
    }));
    EXPECT_TRUE(!slow.step || slow.step->IsInTime()) << amplitude;
    const auto random = JudgeSteadiness(
        SceneWith([&](int, Camera* camera) { Zoom(1 + amplitude * uniform(generator), camera); }));
    EXPECT_TRUE(!random.step || random.step->IsInTime()) << amplitude;
  }
}

TEST(CameraSteadiness, AStabilizedClipIsRecognized) {
  const auto verdict = JudgeSteadiness(SceneWith([](int frame_idx, Camera* camera) {
    camera->params[2] += 40 * std::sin(1.7 * frame_idx);
    camera->params[3] += 30 * std::cos(2.3 * frame_idx);
  }));
  ASSERT_TRUE(verdict.wander);
  EXPECT_TRUE(verdict.wander->SpoilsShape());
  EXPECT_NEAR(verdict.wander->spread_px, 1.48 * 40 / std::sqrt(2), 8);  // robust, of a sine
  EXPECT_THAT(DescribeWander(*verdict.wander), HasSubstr("stabilized"));
}

TEST(CameraSteadiness, AStabilizerThatHardlyMovesDoesNotSpoilTheShape) {
  const auto verdict = JudgeSteadiness(SceneWith([](int frame_idx, Camera* camera) {
    camera->params[2] += 0.008 * camera->params[0] * std::sin(1.7 * frame_idx);
  }));
  EXPECT_FALSE(verdict.wander && verdict.wander->SpoilsShape());
}

double MedianExplainedShare(const Model& model) {
  std::vector<double> shares;
  for (const ImageIntrinsics& image : IntrinsicsOfImages(model)) {
    shares.push_back(image.explained_share);
  }
  return Median(std::move(shares));
}

// Neighbouring corners share the errors of a wave, so that a camera of its own seems to fit better.
TEST(CameraSteadiness, FlappingClothIsNoStabilizer) {
  SyntheticSceneOptions options;
  options.num_frames = 20;
  SyntheticScene scene = MakeSyntheticScene(options);
  const auto& first = scene.x_in_world.begin()->second;
  const Eigen::Vector3d normal = (first[1] - first[3]).cross(first[2] - first[4]).normalized();
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    for (MarkerDetection& marker : scene.frames[i].markers) {
      for (std::size_t c = 0; c < kNumCorners; ++c) {
        const Eigen::Vector3d& x = scene.x_in_world.at(marker.marker_id)[c + 1];
        const double phase = 1.7 * static_cast<double>(i) - 4.0 * (x - first[1]).norm();
        marker.corners_in_image_px[c] = *ImageFromCam(
            scene.camera, scene.cam_from_world[i] * (x + 0.02 * std::sin(phase) * normal));
      }
    }
  }
  AddNoise({0.1, 0, 0, 0, 7}, &scene);
  Model flapping = MakeSceneModel(scene);
  UpdatePointErrors(&flapping);
  EXPECT_LT(MedianExplainedShare(flapping), 0.35);
  EXPECT_FALSE(JudgeSteadiness(flapping).wander);
  const Model stabilized = SceneWith(
      [](int frame_idx, Camera* camera) { camera->params[2] += 40 * std::sin(1.7 * frame_idx); });
  EXPECT_GT(MedianExplainedShare(stabilized), 0.8);
}

}  // namespace
}  // namespace velamap
