#include "reconstruct/problem/marker_problem.h"

#include <cmath>
#include <limits>

#include <ceres/problem.h>
#include <gmock/gmock.h>

#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

class MarkerProblemTest : public testing::Test {
 protected:
  MarkerProblemTest() {
    SyntheticSceneOptions options;
    options.num_rows = 2;
    options.num_columns = 3;
    options.num_frames = 4;
    scene_ = MakeSyntheticScene(options);
    model_ = MakeSceneModel(scene_);
    state_ = MakeMarkerState(model_, scene_.layout);
    weights_.loss_sigmas = std::numeric_limits<double>::infinity();
    weights_.print_tolerance = 1e-3;
  }

  MarkerProblem Make(const CornerErrors& errors = {}) {
    return MakeMarkerProblem({}, model_, errors, model_.cameras, weights_, &state_);
  }

  SyntheticScene scene_;
  Model model_;
  MarkerState state_;
  MarkerWeights weights_;
};

TEST_F(MarkerProblemTest, EveryCornerHasItsSigmaAndTheFloor) {
  const double usual_px = std::hypot(0.1, 0.02);
  EXPECT_THAT(Make().corner_sigmas_px, testing::Each(testing::DoubleNear(usual_px, 1e-12)));
  CornerErrors errors;
  for (const ModelImage& image : model_.images) {
    errors.sigmas_px[image.image_id].assign(image.points2D.size(), 0.015);
  }
  EXPECT_THAT(Make(errors).corner_sigmas_px, testing::Each(testing::DoubleNear(0.025, 1e-12)));
}

// Independent errors of the sides change the difference of the diagonals by root two of them.
TEST_F(MarkerProblemTest, ARhombusIsJudgedByTheDifferenceOfItsDiagonals) {
  constexpr double kShear = 0.004;
  const MarkerProblem problem = Make();
  MarkerBlock& marker = state_.markers[2];
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (int slot = 0; slot < 4; ++slot) center += CornerPosition(marker, slot) / 4;
  for (int slot = 0; slot < 4; ++slot) {
    // Half diagonals of a rhombus whose sides keep their length.
    const double angle = std::atan(1.0) + (slot % 2 == 0 ? kShear : -kShear);
    const Eigen::Vector3d moved =
        center + std::sqrt(2.0) * std::sin(angle) * (CornerPosition(marker, slot) - center);
    for (int axis = 0; axis < 3; ++axis) {
      marker.x_in_world[static_cast<std::size_t>(3 * slot + axis)] = moved[axis];
    }
  }
  const double difference_m = (CornerPosition(marker, 2) - CornerPosition(marker, 0)).norm() -
                              (CornerPosition(marker, 3) - CornerPosition(marker, 1)).norm();
  ceres::Problem::EvaluateOptions options;
  options.residual_blocks = problem.prior_residuals;
  double cost = 0.0;
  ASSERT_TRUE(problem.ceres->Evaluate(options, &cost, nullptr, nullptr, nullptr));
  const double side_sigma_m = std::hypot(weights_.print_tolerance * marker.length_m,
                                         MarkerAdjustmentOptions().print_resolution_m);
  const double sigma_m = std::sqrt(2.0) * side_sigma_m;
  EXPECT_NEAR(cost / (0.5 * std::pow(difference_m / sigma_m, 2)), 1.0, 1e-3);
}

}  // namespace
}  // namespace velamap
