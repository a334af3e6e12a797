#include "reconstruct/solve/schur_complement.h"

#include <cmath>

#include <ceres/autodiff_cost_function.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include "reconstruct/problem/marker_problem.h"
#include "tests/reconstruct/scene_model.h"
#include "tests/reconstruct/sheet_model.h"

namespace velamap {
namespace {

// A noisy scene with outliers, away from its minimum, in which all kinds of parameters vary and two
// scale bars couple markers.
class SchurComplement : public testing::Test {
 protected:
  SchurComplement() {
    SyntheticSceneOptions scene_options;
    scene_options.num_rows = 3;
    scene_options.num_columns = 4;
    scene_options.num_frames = 7;
    SyntheticScene scene = MakeSyntheticScene(scene_options);
    AddNoise({0.1, 0.1, 0, 5, 1}, &scene);
    scene.layout.distances = {{0, 0, 5, 1, 0.6, 1e-3, true}, {1, 0, 4, 0, 0.3, 5e-4, true}};
    model_ = MakeSceneModel(scene);
    for (const ModelImage& image : model_.images) {
      for (std::size_t i = 0; i < image.points2D.size(); ++i) {
        corner_errors_.motions[image.image_id].push_back(
            {{100.0 * image.image_id + 5.0 * i, 0.0}, {}});
      }
    }
    PerturbSeed(0.001, 1, &model_);
    layout_ = scene.layout;
    options_.refine_focal_length = true;
    options_.estimate_inset = true;
  }

  MarkerProblem MakeProblem(MarkerState* state) const {
    MarkerWeights weights;
    weights.loss_sigmas = 3.0;
    weights.print_tolerance = 1e-3;
    weights.frees_rolling_shutter = true;
    weights.scale_bars = layout_.distances;
    return MakeMarkerProblem(options_, model_, corner_errors_, model_.cameras, weights, state);
  }

  MarkerState State() const { return MakeMarkerState(model_, layout_); }

  static double LargestDifference(const MarkerState& a, const MarkerState& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.markers.size(); ++i) {
      for (std::size_t k = 0; k < a.markers[i].x_in_world.size(); ++k) {
        largest =
            std::max(largest, std::abs(a.markers[i].x_in_world[k] - b.markers[i].x_in_world[k]));
      }
    }
    return largest;
  }

  Model model_;
  Layout layout_;
  CornerErrors corner_errors_;
  MarkerAdjustmentOptions options_;
};

// Ceres's own criterion, and no elimination.
void MinimizeByQr(MarkerProblem* problem) {
  ceres::Solver::Options options;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-15;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 0.0;
  options.initial_trust_region_radius = 1e8;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem->ceres.get(), &summary);
  EXPECT_LT(summary.final_cost, 0.5 * summary.initial_cost);
}

TEST_F(SchurComplement, ReachesTheMinimumThatAQrFactorizationFinds) {
  MarkerState by_schur = State(), by_qr = State();
  MarkerProblem problem = MakeProblem(&by_schur), other = MakeProblem(&by_qr);
  MinimizeMarkerProblem(200, 1e-15, &problem);
  MinimizeByQr(&other);
  EXPECT_LT(LargestDifference(by_schur, by_qr), 1e-8);
  EXPECT_GT(LargestDifference(by_schur, State()), 1e-3);
}

// Not all of them can be eliminated then.
TEST_F(SchurComplement, ScaleBarsMayCoupleAllMarkers) {
  layout_.distances.clear();
  for (int marker_id = 0; marker_id < 12; ++marker_id) {
    layout_.distances.push_back({marker_id, 1, (marker_id + 1) % 12, 1, 0.6, 1.0, true});
  }
  MarkerState by_schur = State(), by_qr = State();
  ASSERT_EQ(by_schur.markers.size(), 12u);
  MarkerProblem problem = MakeProblem(&by_schur), other = MakeProblem(&by_qr);
  EXPECT_LT(problem.kept_markers.size(), 12u);
  MinimizeMarkerProblem(200, 1e-15, &problem);
  MinimizeByQr(&other);
  EXPECT_LT(LargestDifference(by_schur, by_qr), 1e-8);
}

TEST_F(SchurComplement, SameInputGivesSameBytes) {
  MarkerState first = State(), second = State();
  for (MarkerState* state : {&first, &second}) {
    MarkerProblem problem = MakeProblem(state);
    MinimizeMarkerProblem(20, 1e-9, &problem);
  }
  EXPECT_EQ(LargestDifference(first, second), 0.0);
}

TEST_F(SchurComplement, LeavesAllValuesWhereAResidualCannotBeEvaluated) {
  MarkerState state = State();
  MarkerProblem problem = MakeProblem(&state);
  state.images.back().cam_from_world[6] -= 1000.0;  // all markers are behind it
  const MarkerState before = state;
  EXPECT_THROW(MinimizeMarkerProblem(20, 1e-9, &problem), std::exception);
  EXPECT_EQ(LargestDifference(state, before), 0.0);
}

// Large residuals that no step can reduce, and small ones that the first step makes zero.
struct ConstantAndLinear {
  template <typename T>
  bool operator()(const T* x, T* residuals) const {
    residuals[0] = T(10);
    residuals[1] = x[0];
    return true;
  }
};

class SchurComplementTolerance : public testing::TestWithParam<bool> {};

TEST_P(SchurComplementTolerance, LastStepIsKeptOnDemand) {
  double eliminated = 1.0, kept = 2.0;
  ceres::Problem problem;
  for (double* x : {&eliminated, &kept}) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<ConstantAndLinear, 2, 1>(new ConstantAndLinear), nullptr,
        x);
  }
  SchurOptions options;
  options.function_tolerance = 0.1;
  options.keeps_last_step = GetParam();
  const SchurSummary summary = MinimizeBySchurComplement(options, {&eliminated}, {&kept}, &problem);
  ASSERT_TRUE(summary.is_usable);
  EXPECT_LE(summary.num_iterations, 1);
  EXPECT_NEAR(summary.initial_cost, 102.5, 1e-9);
  EXPECT_NEAR(summary.final_cost, GetParam() ? 100.0 : 102.5, 1e-3);
  EXPECT_NEAR(kept, GetParam() ? 0.0 : 2.0, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(KeepsLastStep, SchurComplementTolerance, testing::Bool());

}  // namespace
}  // namespace velamap
