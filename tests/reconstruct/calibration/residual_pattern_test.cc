#include "reconstruct/calibration/residual_pattern.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace velamap {
namespace {

// Residuals over a picture of 800 x 600 px: a radial pattern of this size at the corners of the
// picture, and noise.
std::vector<CalibrationResidual> Residuals(double pattern_px, double noise_px,
                                           std::mt19937* random) {
  std::uniform_real_distribution<double> x_px(0, 800), y_px(0, 600);
  std::normal_distribution<double> normal;
  std::vector<CalibrationResidual> residuals;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector2d x(x_px(*random), y_px(*random));
    const Eigen::Vector2d from_center = (x - Eigen::Vector2d(400, 300)) / 500;
    residuals.push_back({x, pattern_px * from_center +
                                noise_px * Eigen::Vector2d(normal(*random), normal(*random))});
  }
  return residuals;
}

TEST(ResidualsInCells, MeanAndRmsOfEachCell) {
  const PictureGrid grid{800, 600, 2, 1};
  const auto cells =
      ResidualsInCells({{{100, 100}, {1, 0}}, {{200, 500}, {3, 0}}, {{700, 10}, {0, 2}}}, grid);
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_EQ(cells[0].num_corners, 2);
  EXPECT_EQ(cells[0].mean_px, Eigen::Vector2d(2, 0));
  EXPECT_NEAR(cells[0].rms_px, std::sqrt(5), 1e-12);
  EXPECT_EQ(cells[1].num_corners, 1);
}

// What is left in the means of independent residuals is subtracted, so noise alone gives nothing
// and hides no pattern.
TEST(SystematicResidual, IsThePatternWithoutTheNoise) {
  std::mt19937 random(5);
  const PictureGrid grid{800, 600, 8, 6};
  for (const double noise_px : {0.0, 0.05, 0.2}) {
    const double without =
        SystematicResidual(ResidualsInCells(Residuals(0, noise_px, &random), grid));
    EXPECT_LT(without, 0.05 * noise_px + 1e-12);
    // The RMS of the distance from the centre is sqrt((800^2 + 600^2) / 12) px.
    const double expected_px = 0.2 * std::hypot(800, 600) / std::sqrt(12) / 500;
    EXPECT_NEAR(SystematicResidual(ResidualsInCells(Residuals(0.2, noise_px, &random), grid)),
                expected_px, 0.1 * expected_px)
        << noise_px;
  }
}

TEST(SystematicResidual, CellsOfFewCornersDoNotCount) {
  EXPECT_EQ(SystematicResidual({{7, {1, 1}, 1.5}, {0, {0, 0}, 0}}), 0.0);
  EXPECT_EQ(SystematicResidual({}), 0.0);
}

}  // namespace
}  // namespace velamap
