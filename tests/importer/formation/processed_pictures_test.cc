// The estimate from pictures that noise filters, compression or curves of another shape have
// changed, none of which a parameter describes.

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "importer/formation/formation_estimation.h"
#include "importer/refine/corner_refinement.h"
#include "tests/importer/formation/formation_scenes.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

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
    const auto refined = RefineCorners(grid.image, grid.starts[k], {grid.cells[k]}, formation);
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
    found.ink_spread_mm += KnownMarker().side_mm * found.edge_shift_blurs *
                           scene.rendering.blur_sigma_px / scene.side_px;
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

// Curves of HDR video, of film-like rendering and of the flat profiles of action cameras are nearly
// logarithms, which are the limit of a power. Small cells show no edge shift, so there the power
// alone has to describe them.
TEST(FormationEstimation, CurvesOfHdrVideoAndFilmDoNotMoveSides) {
  const auto hybrid_log_gamma = [](double light) {  // ITU-R BT.2100, paper at a third of its range
    const double x = 0.35 * light;
    return x < 1.0 / 12 ? std::sqrt(3 * x)
                        : 0.17883277 * std::log(12 * x - 0.28466892) + 0.55991073;
  };
  const auto film = [](double light) {  // a sigmoid over 16.5 stops
    const double stops = std::log2(std::max(light, 1e-4) / 0.18);
    return 1 / (1 + std::exp(-9.5 * ((stops + 10) / 16.5 - 0.606)));
  };
  const auto flat = [](double light) { return std::log(1 + 112 * light) / std::log(113.0); };
  std::mt19937 random(TestSeed());
  for (const double side_px : {36.0, 14.0}) {
    for (double (*encode)(double) : {+hybrid_log_gamma, +film, +flat}) {
      MarkerGridOptions scene = DrawScene(&random);
      scene.side_px = side_px;
      scene.rendering.camera = {};
      MarkerGrid grid = MakeMarkerGrid(scene);
      cv::Mat curve(1, 256, CV_8U);
      for (int i = 0; i < 256; ++i) {
        curve.at<std::uint8_t>(i) = cv::saturate_cast<std::uint8_t>(255 * encode(i / 255.0));
      }
      cv::LUT(grid.image, curve, grid.image);
      const FormationEstimate estimate = EstimateFormation(Samples(grid), false);
      const double bias_px = SideBias(grid, ImageFormation(estimate.parameters));
      EXPECT_LT(std::abs(bias_px), 2 * 2.5 * estimate.inset_sigma_px);  // two corners a side
      EXPECT_LT(std::abs(bias_px), 0.02);
      EXPECT_LT(estimate.inset_sigma_px, 0.02);
      RecordProperty("bias_px", std::to_string(bias_px));
    }
  }
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

}  // namespace
}  // namespace velamap
