#include <cmath>

#include <gtest/gtest.h>

#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/problem/corner_residuals.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

// How much of the sum of squared distances of the corners from their mean is that of the markers.
double ShareBetweenMarkers(const SyntheticScene& scene) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& [marker_id, points] : scene.x_in_world) mean += points[0];
  mean /= static_cast<double>(scene.x_in_world.size());
  double between = 0.0, within = 0.0;
  for (const auto& [marker_id, points] : scene.x_in_world) {
    between += kNumCorners * (points[0] - mean).squaredNorm();
    for (std::size_t i = 1; i < points.size(); ++i) within += (points[i] - points[0]).squaredNorm();
  }
  return between / (between + within);
}

// Distances between markers grow with it; sides are as printed.
TEST(CommonInset, ShortensASideTwiceInTheSigmaOfTheScale) {
  SyntheticSceneOptions scene_options;
  scene_options.num_rows = 3;
  scene_options.num_columns = 4;
  scene_options.num_frames = 9;
  SyntheticScene scene = MakeSyntheticScene(scene_options);
  AddNoise({0.1, 0, 0, 200, 2}, &scene);
  MarkerAdjustmentOptions options;
  options.print_tolerance = options.common_print_tolerance = 1e-4;
  const auto sigma = [&](double by_options_px, double by_database_px) {
    Model model = MakeSceneModel(scene);
    options.inset_sigma_px = by_options_px;
    CornerErrors errors;
    errors.common_inset_px = by_database_px;
    return AdjustWithMarkers(options, scene.layout, errors, &model)
        .uncertainty.relative_scale_sigma;
  };
  const double by_inset =
      ShareBetweenMarkers(scene) * 2 * 0.1 / MedianSidePx(MakeSceneModel(scene));
  const double expected = std::hypot(sigma(0, 0), by_inset);
  EXPECT_GT(expected, 5 * sigma(0, 0));
  EXPECT_NEAR(sigma(0, 0.1), expected, 0.02 * expected);
  EXPECT_NEAR(sigma(0.1, 0), expected, 0.02 * expected);
  EXPECT_NEAR(sigma(0.06, 0.08), expected, 0.02 * expected);
}

TEST(CommonInset, IsAHundredthOfAPixelWithoutAnEstimate) {
  EXPECT_EQ(CornerErrorsOf({}).common_inset_px, 0.01);
}

}  // namespace
}  // namespace velamap
