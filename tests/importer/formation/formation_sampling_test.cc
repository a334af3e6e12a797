#include "importer/formation/formation_sampling.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/importer/formation/formation_scenes.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

FormationEstimate EstimateFromPictures(const TempDir& folder, const MarkerGridOptions& scene) {
  return EstimateFormationOfSource(folder.path().string(), {}, 2,
                                   MakeFrameDetector(MakeLayout(scene.dictionary, 0.1), {}),
                                   [&scene](const Frame&) { return scene.camera; });
}

// A sail that is filmed from far away has no larger markers.
TEST(EstimateFormationOfSource, LearnsFromSmallMarkersWhereThereAreNoOthers) {
  constexpr int kNumPictures = 4;
  MarkerGridOptions scene;
  scene.dictionary = "DICT_4X4_50";
  scene.side_px = 11.5;
  scene.max_tilt_deg = 30.0;
  scene.rendering.black = 15;
  scene.rendering.white = 190;
  scene.rendering.blur_sigma_px = 0.5;
  scene.rendering.noise_sigma = 1.0;
  scene.rendering.camera.gamma = 2.2;
  const TempDir folder;
  MarkerGrid grid;
  for (int i = 0; i < kNumPictures; ++i) {
    scene.rendering.seed = static_cast<std::uint32_t>(1 + i);
    grid = MakeMarkerGrid(scene);
    ASSERT_TRUE(cv::imwrite((folder / (std::to_string(i) + ".png")).string(), grid.image));
  }
  const FormationEstimate estimate = EstimateFromPictures(folder, scene);
  ASSERT_GE(estimate.num_samples, 32);
  EXPECT_LT(estimate.inset_sigma_px, 0.05);
  const double bias_px = SideBias(grid, ImageFormation(estimate.parameters));
  EXPECT_LT(std::abs(bias_px), 2 * 2.5 * estimate.inset_sigma_px);  // two corners a side
  EXPECT_LT(std::abs(bias_px), 0.2 * std::abs(SideBias(grid, ImageFormation())));
  RecordProperty("bias_px", std::to_string(bias_px));
}

TEST(EstimateFormationOfSource, PicturesWithoutMarkersLeaveItUnknown) {
  const TempDir folder;
  const MarkerGridOptions scene;
  ASSERT_TRUE(cv::imwrite((folder / "gray.png").string(),
                          cv::Mat(scene.camera.height_px, scene.camera.width_px, CV_8U, 128)));
  EXPECT_EQ(EstimateFromPictures(folder, scene).num_samples, 0);
}

}  // namespace
}  // namespace velamap
