#include "reconstruct/solve/schur_solver.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <ceres/crs_matrix.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include "reconstruct/adjust/marker_problem.h"
#include "reconstruct/adjust/marker_sizes.h"
#include "tests/reconstruct/adjust/ceres_problem.h"
#include "tests/reconstruct/scene_model.h"
#include "tests/reconstruct/sheet_model.h"

namespace velamap {
namespace {

// A noisy scene with outliers, away from its solution, with everything that varies, and two scale
// bars that couple markers with each other.
class SchurSolver : public testing::Test {
 protected:
  SchurSolver() {
    SyntheticSceneOptions scene_options;
    scene_options.num_rows = 3;
    scene_options.num_columns = 4;
    scene_options.num_frames = 7;
    SyntheticScene scene = MakeSyntheticScene(scene_options);
    AddNoise({0.2, 0.1, 0.02, 5, 1}, &scene);
    scene.layout.distances = {{0, 0, 5, 1, 0.6, 1e-3, true}, {1, 0, 4, 0, 0.3, 5e-4, true}};
    model_ = MakeSceneModel(scene);
    PerturbSeed(0.001, 1, &model_);
    layout_ = scene.layout;
    options_.refine_focal_length = true;
    options_.rolling_shutter_s = 0.01;
    options_.estimate_inset = true;
  }

  MarkerProblem MakeProblem(MarkerState* state) const {
    MarkerWeights weights;
    weights.loss_sigmas = 3.0;
    weights.print_tolerance = 1e-3;
    weights.scale_bars = FindScaleBars(*state, layout_);
    return MakeMarkerProblem(options_, model_, {}, model_.cameras, weights, state);
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
  MarkerAdjustmentOptions options_;
};

TEST_F(SchurSolver, ComesToTheMinimumThatCeresFinds) {
  MarkerState ours = State(), theirs = State();
  const MarkerProblem problem = MakeProblem(&ours), other = MakeProblem(&theirs);
  SchurProblem schur = problem.schur;
  KeepCoupledBlocks(&schur);
  const SchurSummary summary = SolveSchur({200, 1e-15}, schur);
  ASSERT_TRUE(summary.is_usable);
  ceres::Solver::Options options;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-15;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 0.0;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary expected;
  ceres::Solve(options, MakeCeresProblem(other.schur).get(), &expected);
  EXPECT_NEAR(summary.initial_cost / expected.initial_cost, 1.0, 1e-12);
  EXPECT_NEAR(summary.final_cost / expected.final_cost, 1.0, 1e-12);
  EXPECT_LT(summary.final_cost, 0.5 * summary.initial_cost);
  EXPECT_LT(LargestDifference(ours, theirs), 1e-8);
  EXPECT_GT(LargestDifference(ours, State()), 1e-3);
}

TEST_F(SchurSolver, TakesCeressSteps) {
  for (const int num_iterations : {1, 3}) {
    MarkerState ours = State(), theirs = State();
    const MarkerProblem problem = MakeProblem(&ours), other = MakeProblem(&theirs);
    SchurProblem schur = problem.schur;
    KeepCoupledBlocks(&schur);
    EXPECT_EQ(SolveSchur({num_iterations, 1e-15}, schur).num_iterations, num_iterations);
    ceres::Solver::Options options;
    options.max_num_iterations = num_iterations;
    options.function_tolerance = 1e-15;
    options.linear_solver_type = ceres::DENSE_QR;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary expected;
    ceres::Solve(options, MakeCeresProblem(other.schur).get(), &expected);
    EXPECT_LT(LargestDifference(ours, theirs), 1e-8) << num_iterations;
  }
}

TEST_F(SchurSolver, SameInputGivesSameBytes) {
  MarkerState first = State(), second = State();
  for (MarkerState* state : {&first, &second}) {
    MarkerProblem problem = MakeProblem(state);
    SolveMarkerProblem(20, 1e-9, &problem);
  }
  EXPECT_EQ(LargestDifference(first, second), 0.0);
}

TEST_F(SchurSolver, LeavesAllAsItIsWhereAResidualCannotBeEvaluated) {
  MarkerState state = State();
  const MarkerProblem problem = MakeProblem(&state);
  state.images.back().cam_from_world[6] -= 1000.0;  // all markers are behind it
  const MarkerState before = state;
  SchurProblem schur = problem.schur;
  KeepCoupledBlocks(&schur);
  EXPECT_FALSE(SolveSchur({}, schur).is_usable);
  EXPECT_EQ(LargestDifference(state, before), 0.0);
}

TEST_F(SchurSolver, EliminatedBlocksMustNotShareAResidual) {
  MarkerState state = State();
  const MarkerProblem problem = MakeProblem(&state);
  EXPECT_THROW(SolveSchur({}, problem.schur), std::logic_error);
}

TEST_F(SchurSolver, NormalEquationsAreThoseOfTheDenseJacobian) {
  MarkerState state = State();
  const MarkerProblem problem = MakeProblem(&state);
  SchurProblem schur = problem.schur;
  KeepCoupledBlocks(&schur);
  const SchurStructure structure = MakeSchurStructure(schur);
  SchurSystem system;
  ASSERT_TRUE(Linearise(schur, structure, &system));
  EXPECT_NEAR(EvaluateCost(schur) / system.cost, 1.0, 1e-14);

  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = VaryingBlocks(schur);
  ceres::CRSMatrix sparse;
  double cost = 0.0;
  std::vector<double> gradient;
  MakeCeresProblem(schur)->Evaluate(options, &cost, nullptr, &gradient, &sparse);
  EXPECT_NEAR(system.cost / cost, 1.0, 1e-12);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row) {
    for (int i = sparse.rows[row]; i < sparse.rows[row + 1]; ++i) {
      jacobian(row, sparse.cols[i]) += sparse.values[i];
    }
  }
  // First column of each block in the dense Jacobian.
  std::vector<Eigen::Index> begins(schur.blocks.size(), -1);
  Eigen::Index num_columns = 0;
  for (std::size_t i = 0; i < schur.blocks.size(); ++i) {
    if (schur.blocks[i].kind == SchurBlock::Kind::kConstant) continue;
    begins[i] = num_columns;
    num_columns += schur.blocks[i].TangentSize();
  }
  const Eigen::MatrixXd hessian = jacobian.transpose() * jacobian;
  const auto expect_block = [&](int a, int b, const Eigen::MatrixXd& block) {
    const Eigen::MatrixXd expected =
        hessian.block(begins[a], begins[b], block.rows(), block.cols());
    EXPECT_LT((block - expected).norm(), 1e-10 * (1.0 + expected.norm())) << a << " " << b;
  };
  ASSERT_FALSE(structure.eliminated.empty());
  for (std::size_t i = 0; i < structure.eliminated.size(); ++i) {
    const SchurStructure::Eliminated& place = structure.eliminated[i];
    expect_block(place.block_idx, place.block_idx, system.eliminated[i].hessian);
    Eigen::Index column = 0;
    for (const int kept_idx : place.kept_block_idxs) {
      const int size = schur.blocks[kept_idx].TangentSize();
      expect_block(place.block_idx, kept_idx,
                   system.eliminated[i].coupling.middleCols(column, size));
      column += size;
    }
    for (Eigen::Index k = 0; k < system.eliminated[i].gradient.size(); ++k) {
      const double expected = gradient[begins[place.block_idx] + k];
      EXPECT_NEAR(system.eliminated[i].gradient[k], expected, 1e-9 * (1.0 + std::abs(expected)));
    }
  }
  for (const int a : structure.kept_block_idxs) {
    for (const int b : structure.kept_block_idxs) {
      expect_block(
          a, b,
          system.kept_hessian.block(structure.column_of_block[a], structure.column_of_block[b],
                                    schur.blocks[a].TangentSize(), schur.blocks[b].TangentSize()));
    }
  }
}

}  // namespace
}  // namespace velamap
