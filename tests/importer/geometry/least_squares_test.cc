#include "importer/geometry/least_squares.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace velamap {
namespace {

// y = p0 exp(p1 t) at some t, and how often it was evaluated.
struct Decay : LeastSquaresProblem<2> {
  using Parameters = Eigen::Vector2d;

  std::vector<double> t = {0.0, 0.3, 0.7, 1.2, 2.0};
  double max_rate = 0.0;  // larger ones are inadmissible
  mutable int num_evaluations = 0;
  mutable int num_hessians = 0;

  void Evaluate(const Eigen::Vector2d& p, bool with_hessian, Equations* equations) const {
    ++num_evaluations;
    num_hessians += with_hessian;
    *equations = {};
    for (const double x : t) {
      const double decay = std::exp(p[1] * x);
      equations->Add<1>(Eigen::RowVector2d(decay, p[0] * x * decay),
                        Eigen::Matrix<double, 1, 1>(p[0] * decay - 3 * std::exp(-0.7 * x)));
    }
    if (p[1] > max_rate) equations->Reject();
  }
  Eigen::Vector2d Plus(const Eigen::Vector2d& p, const Step& step) const { return p + step; }
};

LeastSquaresOptions Exact() {
  LeastSquaresOptions options;
  options.max_iterations = 50;
  options.min_step = 1e-12;
  return options;
}

TEST(MinimizeSquares, FindsTheMinimum) {
  const Decay decay;
  Eigen::Vector2d p(1.0, -0.01);
  Decay::Equations equations;
  EXPECT_EQ(MinimizeSquares(Exact(), decay, &p, &equations), Convergence::kConverged);
  EXPECT_NEAR(p[0], 3.0, 1e-10);
  EXPECT_NEAR(p[1], -0.7, 1e-10);
  EXPECT_LT(equations.cost(), 1e-20);
}

TEST(MinimizeSquares, NeverLeavesParametersThatCostMoreThanTheStart) {
  Decay decay;
  decay.max_rate = -0.75;  // the minimum is out of reach
  Eigen::Vector2d p(1.0, -2.0);
  Decay::Equations start, equations;
  decay.Evaluate(p, true, &start);
  EXPECT_NE(MinimizeSquares(Exact(), decay, &p, &equations), Convergence::kFailed);
  EXPECT_LE(p[1], decay.max_rate);
  decay.Evaluate(p, true, &equations);
  EXPECT_LT(equations.cost(), start.cost());
}

TEST(MinimizeSquares, AStepBelowTheSmallestIsTakenWithoutALook) {
  const Decay decay;
  LeastSquaresOptions options = Exact();
  options.min_step = 1e3;
  Eigen::Vector2d p(2.9, -0.69);
  Decay::Equations equations;
  EXPECT_EQ(MinimizeSquares(options, decay, &p, &equations), Convergence::kConverged);
  EXPECT_EQ(decay.num_evaluations, 1);
  EXPECT_NEAR(p[0], 3.0, 0.01);
}

TEST(MinimizeSquares, TheHessianIsTakenOverAfterShortSteps) {
  const Decay decay;
  LeastSquaresOptions options = Exact();
  options.min_step_for_new_hessian = 1e3;
  Eigen::Vector2d p(2.9, -0.69);
  Decay::Equations equations;
  MinimizeSquares(options, decay, &p, &equations);
  EXPECT_GT(decay.num_evaluations, 2);
  EXPECT_LT(decay.num_hessians, decay.num_evaluations);
}

TEST(MinimizeSquares, ASmallDecreaseEndsTheSearch) {
  LeastSquaresOptions loose = Exact();
  loose.min_relative_decrease = 0.999999;
  const Decay decay;
  Eigen::Vector2d p(1.0, -0.01);
  Decay::Equations equations;
  EXPECT_EQ(MinimizeSquares(loose, decay, &p, &equations), Convergence::kConverged);
  EXPECT_GT((p - Eigen::Vector2d(3.0, -0.7)).norm(), 1e-6);
}

TEST(MinimizeSquares, SaysWhereThereIsNothingToStartFrom) {
  Decay inadmissible;
  inadmissible.max_rate = -1.0;
  Eigen::Vector2d p(1.0, -0.5);
  Decay::Equations equations;
  EXPECT_EQ(MinimizeSquares(Exact(), inadmissible, &p, &equations), Convergence::kFailed);
  EXPECT_EQ(p, Eigen::Vector2d(1.0, -0.5));
  Decay singular;
  singular.t.clear();
  EXPECT_EQ(MinimizeSquares(Exact(), singular, &p, &equations), Convergence::kFailed);
  EXPECT_EQ(p, Eigen::Vector2d(1.0, -0.5));
}

TEST(MinimizeSquares, StopsOutOfIterations) {
  const Decay decay;
  LeastSquaresOptions options = Exact();
  options.max_iterations = 2;
  Eigen::Vector2d p(1.0, -0.01);
  Decay::Equations equations;
  EXPECT_EQ(MinimizeSquares(options, decay, &p, &equations), Convergence::kNotConverged);
  EXPECT_LE(decay.num_evaluations, 5);
}

TEST(CauchyLoss, WeightIsTheDerivativeAndSmallResidualsCountInFull) {
  const CauchyLoss loss{4.0};
  for (const double s : {0.0, 0.5, 4.0, 100.0}) {
    const double h = 1e-6 * (1 + s);
    EXPECT_NEAR(loss.Weight(s), (loss.Value(s + h) - loss.Value(s - h)) / (2 * h), 1e-7) << s;
  }
  EXPECT_NEAR(loss.Value(1e-6), 1e-6, 1e-12);
  EXPECT_LT(loss.Value(1e6), 100.0);
}

}  // namespace
}  // namespace velamap
