#include "importer/formation/formation_estimation.h"

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "tests/importer/formation/formation_scenes.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

class FormationEstimationTest : public testing::TestWithParam<int> {};

TEST_P(FormationEstimationTest, MakesSidesUnbiasedForRandomCamerasAndMargins) {
  std::mt19937 random(TestSeed());
  const MarkerGridOptions scene = DrawScene(&random);
  const MarkerGrid grid = MakeMarkerGrid(scene);
  const FormationEstimate estimate = EstimateFormation(Samples(grid), false);
  ASSERT_GE(estimate.num_samples, 12);
  const ImageFormationParameters& camera = scene.rendering.camera;
  const std::string drawn = "side " + std::to_string(scene.side_px) + " px, gamma " +
                            std::to_string(camera.gamma) + ", found " +
                            std::to_string(estimate.parameters.gamma) + ", S " +
                            std::to_string(camera.s_amplitude) + ", margin " +
                            std::to_string(scene.rendering.quiet_zone_cells) + " cells";
  const double bias_px = SideBias(grid, ImageFormation(estimate.parameters));
  EXPECT_LT(std::abs(bias_px), scene.side_px > 25 ? 0.03 : 0.05) << drawn;
  EXPECT_LT(std::abs(bias_px), 2 * 2.5 * estimate.inset_sigma_px) << drawn;  // two corners a side
  const double linear_bias_px = SideBias(grid, ImageFormation());
  if (camera.gamma > 1.8 && scene.side_px > 25) {
    EXPECT_LT(linear_bias_px, -0.1) << drawn;
  }
  RecordProperty("bias_px", std::to_string(bias_px));
  RecordProperty("linear_bias_px", std::to_string(linear_bias_px));
}

INSTANTIATE_TEST_SUITE_P(Draws, FormationEstimationTest, testing::Range(0, 6));

TEST(FormationEstimation, LinearCameraIsFoundLinear) {
  std::mt19937 random(TestSeed());
  MarkerGridOptions scene = DrawScene(&random);
  scene.side_px = 30;
  scene.rendering.camera = {};
  scene.rendering.noise_sigma = 1.0;
  const MarkerGrid grid = MakeMarkerGrid(scene);
  const FormationEstimate estimate = EstimateFormation(Samples(grid), false);
  EXPECT_NEAR(estimate.parameters.gamma, 1.0, 0.1);
  EXPECT_NEAR(estimate.parameters.s_amplitude, 0.0, 0.015);
  EXPECT_NEAR(estimate.parameters.sharpening, 0.0, 0.15);
  EXPECT_LT(std::abs(SideBias(grid, ImageFormation(estimate.parameters))), 0.03);
}

// A lens that scatters light lowers the contrast of cells as a negative sharpening does, but before
// the tone curve. Bright backgrounds scatter their light onto the marker, too.
TEST(FormationEstimation, HaloIsTakenForAHalo) {
  std::mt19937 random(TestSeed());
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int draw = 0; draw < 3; ++draw) {
    MarkerGridOptions scene = DrawScene(&random);
    RenderOptions& rendering = scene.rendering;
    scene.side_px = 24 + 20 * unit(random);
    rendering.white = 180;
    rendering.background = rendering.white * (0.1 + unit(random));
    if (draw == 0) rendering.camera = {};
    rendering.camera.halo = 0.05 + 0.07 * unit(random);
    rendering.camera.halo_radius_px = 2.2 + 1.5 * unit(random);
    const MarkerGrid grid = MakeMarkerGrid(scene);
    const FormationEstimate estimate = EstimateFormation(Samples(grid), false);
    EXPECT_NEAR(estimate.parameters.halo, rendering.camera.halo, 0.03) << draw;
    EXPECT_NEAR(estimate.parameters.sharpening, rendering.camera.sharpening, 0.15) << draw;
    const double bias_px = SideBias(grid, ImageFormation(estimate.parameters));
    EXPECT_LT(std::abs(bias_px), 0.01) << draw;
    EXPECT_LT(std::abs(bias_px), 2 * 2.5 * estimate.inset_sigma_px) << draw;
  }
}

// Nothing describes a camera that sharpens light, before it encodes; the scenes above sharpen grey
// values.
TEST(FormationEstimation, SharpenedLightDoesNotMoveSides) {
  std::mt19937 random(TestSeed());
  for (const double sharpening : {0.2, 0.5, 0.8}) {
    MarkerGridOptions scene = DrawScene(&random);
    scene.side_px = 36;
    scene.rendering.camera = {2.2, 0.0, sharpening, 1.0};
    scene.rendering.sharpens_light = true;
    const MarkerGrid grid = MakeMarkerGrid(scene);
    const FormationEstimate estimate = EstimateFormation(Samples(grid), false);
    const double bias_px = SideBias(grid, ImageFormation(estimate.parameters));
    EXPECT_LT(std::abs(bias_px), 0.02) << sharpening;
    EXPECT_LT(std::abs(bias_px), 2 * 2.5 * estimate.inset_sigma_px) << sharpening;
  }
}

// Paper in the sun is brighter than the camera can record, and so are halos of sharpened edges.
TEST(FormationEstimation, ClippedWhiteDoesNotMoveSides) {
  std::mt19937 random(TestSeed());
  for (const double white : {250.0, 320.0}) {
    MarkerGridOptions scene = DrawScene(&random);
    scene.side_px = 30;
    scene.camera = {CameraModel::kPinhole, 500, 400, {800, 800, 250, 200}};
    scene.rendering.white = white;
    const MarkerGrid grid = MakeMarkerGrid(scene);
    ASSERT_GT(cv::countNonZero(grid.image == 255), 0);
    const FormationEstimate estimate = EstimateFormation(Samples(grid), false);
    EXPECT_GE(estimate.num_samples, 12);
    EXPECT_LT(estimate.inset_sigma_px, 0.05);
    EXPECT_LT(std::abs(SideBias(grid, ImageFormation(estimate.parameters))), 0.03)
        << "white " << white << ", gamma " << scene.rendering.camera.gamma << ", sharpening "
        << scene.rendering.camera.sharpening;
  }
}

// One marker with cells of two pixels does not show how wide its narrow margin is; all do.
TEST(FormationEstimation, SmallMarkersTellTheirQuietZoneTogether) {
  std::mt19937 random(TestSeed());
  for (const double quiet_zone_cells : {0.45, 0.6, 1.0}) {
    MarkerGridOptions scene = DrawScene(&random);
    scene.side_px = 13;
    scene.rendering.quiet_zone_cells = quiet_zone_cells;
    scene.rendering.background = 40;
    scene.rendering.blur_sigma_px = 0.9;
    scene.rendering.camera = {};
    const MarkerGrid grid = MakeMarkerGrid(scene);
    const FormationEstimate estimate = EstimateFormation(Samples(grid), false);
    EXPECT_NEAR(estimate.parameters.quiet_zone_cells, quiet_zone_cells, 0.15);
    EXPECT_LT(std::abs(SideBias(grid, ImageFormation(estimate.parameters))), 0.05)
        << quiet_zone_cells;
  }
}

// Up to 30 grey levels, all samples can be fitted, and hardly any at 40.
TEST(FormationEstimation, NoiseWidensTheSigmaOfTheInset) {
  std::mt19937 random(TestSeed());
  MarkerGridOptions scene = DrawScene(&random);
  scene.side_px = 30;
  double before_px = 0.0;
  for (const double noise_sigma : {1.0, 10.0, 20.0, 30.0, 40.0}) {
    scene.rendering.noise_sigma = noise_sigma;
    const double sigma_px = EstimateFormation(Samples(MakeMarkerGrid(scene)), false).inset_sigma_px;
    EXPECT_GT(sigma_px, before_px);
    before_px = sigma_px;
  }
}

// Before dark cloth, a narrow quiet zone looks almost like a wider and dimmer one, whose outline
// lies farther inside.
TEST(FormationEstimation, NarrowQuietZonesBeforeDarkClothDoNotMoveSides) {
  std::mt19937 random(TestSeed());
  double sum_px = 0.0;
  int num_draws = 0;
  for (const double quiet_zone_cells : {0.36, 0.45, 0.55}) {
    for (const double blur_sigma_px : {0.6, 1.0}) {
      MarkerGridOptions scene = DrawScene(&random);
      scene.side_px = 31;
      scene.rendering.quiet_zone_cells = quiet_zone_cells;
      scene.rendering.background = 30;
      scene.rendering.blur_sigma_px = blur_sigma_px;
      scene.rendering.noise_sigma = 0.5;
      scene.rendering.camera = {};
      const MarkerGrid grid = MakeMarkerGrid(scene);
      const FormationEstimate estimate = EstimateFormation(Samples(grid), false);
      const double bias_px = SideBias(grid, ImageFormation(estimate.parameters));
      sum_px += std::abs(bias_px);
      ++num_draws;
    }
  }
  RecordProperty("mean_bias_px", std::to_string(sum_px / num_draws));
  EXPECT_LT(sum_px / num_draws, 0.012);
}

TEST(FormationEstimation, NothingIsKnownWithoutSamples) {
  const FormationEstimate estimate = EstimateFormation({}, false);
  EXPECT_EQ(estimate.num_samples, 0);
  EXPECT_EQ(estimate.inset_sigma_px, 0.2);
}

}  // namespace
}  // namespace velamap
