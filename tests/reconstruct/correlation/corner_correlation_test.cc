#include "reconstruct/correlation/corner_correlation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "importer/base/statistics.h"
#include "reconstruct/problem/corner_whitening.h"
#include "tests/reconstruct/problem/tiny_scene.h"
#include "tests/reconstruct/scene_model.h"
#include "tests/reconstruct/sheet_model.h"

namespace velamap {
namespace {

TEST(CornerWhitening, ItsInverseGivesIndependentErrorsTheCorrelation) {
  for (const double correlation : {-0.2, 0.0, 0.3, 0.7}) {
    for (int num_corners = 1; num_corners <= kNumCorners; ++num_corners) {
      Eigen::MatrixXd root = Eigen::MatrixXd::Identity(2 * num_corners, 2 * num_corners);
      Whiten(CornerWhitening::Of(correlation, num_corners).Inverse(), root);
      const Eigen::MatrixXd covariance = root * root.transpose();
      for (int i = 0; i < covariance.rows(); ++i) {
        for (int j = 0; j < covariance.cols(); ++j) {
          const double expected = i == j ? 1.0 : (i - j) % 2 == 0 ? correlation : 0.0;
          EXPECT_NEAR(covariance(i, j), expected, 1e-12);
        }
      }
    }
  }
}

SyntheticScene ExactScene() {
  SyntheticSceneOptions options;
  options.num_rows = 3;
  options.num_columns = 4;
  options.num_frames = 20;
  return MakeSyntheticScene(options);
}

SyntheticScene NoisyScene(double corner_correlation, std::uint32_t seed) {
  SyntheticScene scene = ExactScene();
  SyntheticNoiseOptions noise;
  noise.corner_sigma_px = 0.1;
  noise.corner_correlation = corner_correlation;
  noise.seed = seed;
  AddNoise(noise, &scene);
  return scene;
}

// Whatever the problem has assumed.
TEST(EstimateCornerCorrelation, IsThatOfTheErrors) {
  std::uint32_t seed = 0;
  for (const double correlation : {0.0, 0.2, 0.4}) {
    for (const double assumed : {0.0, 0.4}) {
      const SyntheticScene scene = NoisyScene(correlation, ++seed);
      const Model model = MakeSceneModel(scene);
      MarkerState state = MakeMarkerState(model, scene.layout);
      MarkerWeights weights = WeightsWithoutLoss();
      weights.corner_correlation = assumed;
      MarkerProblem problem = MakeMarkerProblem({}, model, {}, model.cameras, weights, &state);
      MinimizeMarkerProblem(50, 1e-9, &problem);
      const MarkerJacobian jacobian = EvaluateJacobian(problem);
      const auto covariance = InvertNormalEquations(jacobian, 1);
      ASSERT_TRUE(covariance.has_value());
      EXPECT_NEAR(EstimateCornerCorrelation(problem, jacobian, *covariance), correlation, 0.07);
    }
  }
}

TEST(EstimateCornerCorrelation, RoundingErrorsGiveOneWithinItsLimits) {
  const SyntheticScene scene = TinyScene();
  Model model = MakeSceneModel(scene);
  MarkerState state = MakeMarkerState(model, scene.layout);
  MarkerProblem problem =
      MakeMarkerProblem({}, model, {}, model.cameras, WeightsWithoutLoss(), &state);
  MarkerJacobian jacobian = EvaluateJacobian(problem);
  const double correlation =
      EstimateCornerCorrelation(problem, jacobian, *InvertNormalEquations(jacobian, 1));
  EXPECT_GE(correlation, -0.2);
  EXPECT_LE(correlation, 0.5);
}

// As on cloth that flaps. Their shapes are then worth more than their places.
TEST(CornerCorrelation, MarkersThatMoveAsAWholeAreFoundBetter) {
  const Model truth = MakeSceneModel(ExactScene());
  double independent = 0.0, correlated = 0.0;
  for (std::uint32_t draw = 0; draw < 20; ++draw) {
    const SyntheticScene scene = NoisyScene(0.99, 100 + draw);
    for (const double assumed : {0.0, 0.5}) {
      Model model = MakeSceneModel(scene);
      MarkerState state = MakeMarkerState(model, scene.layout);
      MarkerWeights weights = WeightsWithoutLoss();
      weights.corner_correlation = assumed;
      MarkerProblem problem = MakeMarkerProblem({}, model, {}, model.cameras, weights, &state);
      MinimizeMarkerProblem(50, 1e-9, &problem);
      WriteMarkerState(state, &model);
      (assumed > 0 ? correlated : independent) += std::pow(Rms(PointErrors(model, truth)), 2);
    }
  }
  EXPECT_LT(correlated, 0.97 * independent);
}

}  // namespace
}  // namespace velamap
