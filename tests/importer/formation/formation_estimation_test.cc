#include "importer/formation/formation_estimation.h"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "importer/refine/corner_refinement.h"
#include "tests/importer/refine/marker_grid.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

// A grid of markers seen by a camera and printed with margins that are drawn at random over what
// cameras and scissors do.
MarkerGridOptions DrawScene(std::mt19937* random) {
  const auto draw = [random](double min, double max) {
    return std::uniform_real_distribution<double>(min, max)(*random);
  };
  MarkerGridOptions options;
  options.dictionary = "DICT_4X4_50";
  options.side_px = draw(18, 60);
  options.camera = {CameraModel::kPinhole, 1400, 1000, {2000, 2000, 700, 500}};
  RenderOptions& rendering = options.rendering;
  rendering.black = draw(8, 25);
  rendering.white = draw(140, 215);
  rendering.background = draw(15, 150);
  rendering.quiet_zone_cells = draw(0.7, 1.4);
  rendering.blur_sigma_px = draw(0.5, 0.9);
  rendering.noise_sigma = 1.0;
  rendering.camera.gamma = draw(1.0, 2.6);
  rendering.camera.s_amplitude = draw(0.0, 0.06);
  rendering.camera.sharpening = draw(0.0, 0.7);
  rendering.camera.sharpening_radius_px = draw(0.8, 1.3);
  return options;
}

std::vector<FormationSample> Samples(const MarkerGrid& grid) {
  constexpr std::size_t kNumSamples = 16;
  std::vector<FormationSample> samples;
  for (std::size_t k = 0; k < std::min(kNumSamples, grid.starts.size()); ++k) {
    samples.push_back({grid.image, grid.starts[k], grid.cells[k]});
  }
  return samples;
}

// Mean error of the side in px.
double SideBias(const MarkerGrid& grid, const ImageFormation& formation) {
  double sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < grid.truth.size(); ++k) {
    const auto refined = RefineCorners(grid.image, grid.starts[k], grid.cells[k], formation);
    if (!refined) continue;
    sum += QuadMeanSide(refined->corners_px) - QuadMeanSide(grid.truth[k]);
    ++count;
  }
  EXPECT_GE(count, static_cast<int>(grid.truth.size()) * 9 / 10);
  return sum / count;
}

// By how much more the long sides of slanted markers are moved apart than the short ones, px: the
// least-squares slope of the errors of all distances between opposite sides, from half the side of
// an upright marker to the whole.
double SlantBias(const MarkerGrid& grid, double side_px, const ImageFormation& formation) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  const auto extents = [](const QuadCorners& q) {
    return Eigen::Vector2d(0.5 * (q[1] - q[0] + q[2] - q[3]).norm(),
                           0.5 * (q[3] - q[0] + q[2] - q[1]).norm());
  };
  for (std::size_t k = 0; k < grid.truth.size(); ++k) {
    const auto refined = RefineCorners(grid.image, grid.starts[k], grid.cells[k], formation);
    if (!refined) continue;
    const Eigen::Vector2d truth_px = extents(grid.truth[k]);
    const Eigen::Vector2d error_px = extents(refined->corners_px) - truth_px;
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector2d by(1.0, truth_px[i] / side_px);
      information += by * by.transpose();
      gradient += by * error_px[i];
    }
  }
  return 0.5 * information.ldlt().solve(gradient)[1];
}

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
// the tone curve. The background is what the light comes from, so it may be bright.
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

// A median leaves straight edges where they are and rounds corners, as noise filters of cameras do.
TEST(FormationEstimation, RoundedCornersDoNotMoveSides) {
  std::mt19937 random(TestSeed());
  for (int draw = 0; draw < 3; ++draw) {
    MarkerGridOptions scene = DrawScene(&random);
    scene.side_px = 42;
    scene.rendering.camera.s_amplitude = scene.rendering.camera.sharpening = 0.0;
    MarkerGrid grid = MakeMarkerGrid(scene);
    cv::medianBlur(grid.image, grid.image, 5);
    ImageFormationParameters found = EstimateFormation(Samples(grid), false).parameters;
    EXPECT_LT(found.outline_corner_weight, 0.5);
    const double bias_px = SideBias(grid, ImageFormation(found));
    EXPECT_LT(std::abs(bias_px), 0.05) << draw;
    found.outline_corner_weight = 1.0;
    const double bias_with_corners_px = SideBias(grid, ImageFormation(found));
    EXPECT_LT(bias_with_corners_px, bias_px) << draw;
    RecordProperty("bias_px", std::to_string(bias_px) + " " + std::to_string(bias_with_corners_px));
  }
}

// Film-like curves have another shape than the model's, which leaves edges moved by a part of their
// blur. As ink, a length on the paper, it would be shorter across slanted markers.
TEST(FormationEstimation, CurvesOfAnotherShapeDoNotDrawOutSlantedMarkers) {
  std::mt19937 random(TestSeed());
  double sum_px = 0.0, sum_as_ink_px = 0.0;
  for (int draw = 0; draw < 2; ++draw) {
    MarkerGridOptions scene = DrawScene(&random);
    scene.side_px = 36;
    scene.rendering.camera = {};
    MarkerGrid grid = MakeMarkerGrid(scene);
    cv::Mat curve(1, 256, CV_8U);  // Narkowicz, "ACES filmic tone mapping curve", 2016
    for (int i = 0; i < 256; ++i) {
      const double x = 1.2 * i / 255;
      const double y = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
      curve.at<std::uint8_t>(i) = cv::saturate_cast<std::uint8_t>(255 * std::sqrt(y));
    }
    cv::LUT(grid.image, curve, grid.image);
    cv::bilateralFilter(grid.image.clone(), grid.image, 5, 18, 1.2);
    ImageFormationParameters found = EstimateFormation(Samples(grid), false).parameters;
    const double bias_px = SlantBias(grid, scene.side_px, ImageFormation(found));
    found.ink_spread_sides +=
        found.edge_shift_blurs * scene.rendering.blur_sigma_px / scene.side_px;
    found.edge_shift_blurs = 0.0;
    const double as_ink_px = SlantBias(grid, scene.side_px, ImageFormation(found));
    EXPECT_LT(std::abs(bias_px), 0.07) << draw;
    sum_px += std::abs(bias_px);
    sum_as_ink_px += std::abs(as_ink_px);
    RecordProperty("bias_px_" + std::to_string(draw),
                   std::to_string(bias_px) + " " + std::to_string(as_ink_px));
  }
  EXPECT_LT(sum_px, 0.4 * sum_as_ink_px);
}

// A median takes a narrow quiet zone for noise and moves the outline of the black square, which no
// shift of all edges explains; the edges within, which tell how large the marker is, count as much.
TEST(FormationEstimation, NarrowQuietZonesInNoiseFiltersDoNotMoveCorners) {
  std::mt19937 random(TestSeed());
  double sum_px = 0.0, unshifted_sum_px = 0.0;
  for (int draw = 0; draw < 5; ++draw) {
    MarkerGridOptions scene = DrawScene(&random);
    scene.side_px = 32;
    scene.rendering.quiet_zone_cells = 0.45;
    MarkerGrid grid = MakeMarkerGrid(scene);
    cv::medianBlur(grid.image.clone(), grid.image, 3);
    const FormationEstimate estimate = EstimateFormation(Samples(grid), false);
    ImageFormationParameters found = estimate.parameters;
    const double bias_px = SideBias(grid, ImageFormation(found));
    found.outline_shift_blurs = 0.0;
    const double unshifted_px = SideBias(grid, ImageFormation(found));
    sum_px += std::abs(bias_px);
    unshifted_sum_px += std::abs(unshifted_px);
    EXPECT_LT(std::abs(bias_px), 2 * 2.5 * estimate.inset_sigma_px) << draw;  // two corners a side
    RecordProperty("bias_px_" + std::to_string(draw),
                   std::to_string(bias_px) + " " + std::to_string(unshifted_px));
  }
  EXPECT_LT(sum_px, 0.92 * unshifted_sum_px);
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

// Compression moves the inner edges of small blurred cells. Outlines that follow them by half make
// the sides 0.07 px too long.
TEST(FormationEstimation, CompressedSmallCellsDoNotDrawOutCorners) {
  std::mt19937 random(TestSeed());
  double sum_px = 0.0;
  int num_draws = 0;
  for (const int jpeg_quality : {30, 50, 70}) {
    for (const double blur_sigma_px : {0.95, 1.1}) {
      MarkerGridOptions scene = DrawScene(&random);
      scene.side_px = 14.5;
      scene.rendering.quiet_zone_cells = 0.9;
      scene.rendering.background = 60;
      scene.rendering.blur_sigma_px = blur_sigma_px;
      scene.rendering.camera = {};
      MarkerGrid grid = MakeMarkerGrid(scene);
      std::vector<std::uint8_t> bytes;
      cv::imencode(".jpg", grid.image, bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality});
      grid.image = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
      const FormationEstimate estimate = EstimateFormation(Samples(grid), false);
      const double bias_px = SideBias(grid, ImageFormation(estimate.parameters));
      EXPECT_LT(std::abs(bias_px), 2 * 2.5 * estimate.inset_sigma_px);  // two corners a side
      sum_px += std::abs(bias_px);
      ++num_draws;
    }
  }
  RecordProperty("mean_bias_px", std::to_string(sum_px / num_draws));
  EXPECT_LT(sum_px / num_draws, 0.03);
}

TEST(FormationEstimation, NothingIsKnownWithoutSamples) {
  const FormationEstimate estimate = EstimateFormation({}, false);
  EXPECT_EQ(estimate.num_samples, 0);
  EXPECT_EQ(estimate.inset_sigma_px, 0.2);
}

}  // namespace
}  // namespace velamap
