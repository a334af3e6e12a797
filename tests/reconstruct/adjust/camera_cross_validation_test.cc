#include "reconstruct/adjust/camera_cross_validation.h"

#include <gtest/gtest.h>

#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

const CornerErrors kUnknownErrors;

// The scene adjusted with an unknown camera.
MarkerSolution SolutionOf(const SyntheticScene& scene) {
  MarkerSolution solution;
  solution.options.find_camera = true;
  solution.layout = &scene.layout;
  solution.corner_errors = &kUnknownErrors;
  solution.model = MakeSceneModel(scene);
  solution.calibration = solution.model.cameras;
  solution.state = MakeMarkerState(solution.model, scene.layout);
  solution.weights.loss_sigmas = 5.0;
  solution.weights.print_tolerance = 0.01;
  Minimize(1e-9, &solution);
  return solution;
}

// Every picture twice, with the same errors, under names that follow each other.
SyntheticScene WithEachTwice(const SyntheticScene& scene) {
  SyntheticScene twice = scene;
  twice.frames.clear();
  twice.cam_from_world.clear();
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    for (const char* name : {"a", "b"}) {
      twice.frames.push_back(scene.frames[i]);
      twice.frames.back().image_name = std::to_string(i) + name;
      twice.cam_from_world.push_back(scene.cam_from_world[i]);
    }
  }
  return twice;
}

TEST(JackknifeCameras, PicturesThatShareTheirErrorsAddNothing) {
  SyntheticSceneOptions options;
  options.num_rows = 3;
  options.num_columns = 4;
  options.num_frames = 20;
  options.camera = {CameraModel::kSimpleRadial, 1920, 1080, {1500, 960, 540, -0.05}};
  SyntheticScene scene = MakeSyntheticScene(options);
  AddNoise({0.2, 0, 0, 200, 1}, &scene);
  const SyntheticScene twice = WithEachTwice(scene);
  const auto once_sigmas = JackknifeCameras(SolutionOf(scene)).at(1);
  const auto twice_sigmas = JackknifeCameras(SolutionOf(twice)).at(1);
  ASSERT_EQ(twice_sigmas.size(), once_sigmas.size());
  for (std::size_t i = 0; i < once_sigmas.size(); ++i) {
    EXPECT_GT(once_sigmas[i], 0.0) << i;
    EXPECT_NEAR(twice_sigmas[i] / once_sigmas[i], 1.0, 0.1) << i;
  }
}

}  // namespace
}  // namespace velamap
