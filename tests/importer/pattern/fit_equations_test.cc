#include "importer/pattern/fit_equations.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "importer/geometry/least_squares.h"

namespace velamap {
namespace {

// y = p0 exp(p1 t) + ..., ten parameters of which eight are held at zero by their priors.
using Vector = FitEquations<10>::Vector;

struct Decay {
  using Parameters = Vector;
  using Equations = FitEquations<10>;
  using Step = Vector;

  Vector mean = Vector::Zero(), weight = Vector::Constant(1e6);
  Eigen::ArrayXd t, y;
  mutable int num_evaluations = 0;

  explicit Decay(int count) {
    weight.head<2>().setConstant(1e-9);
    t = Eigen::ArrayXd::LinSpaced(count, 0, 2);
    y = 3 * (-0.7 * t).exp();
  }

  void Evaluate(const Vector& p, bool with_hessian, FitEquations<10>* equations) const {
    ++num_evaluations;
    equations->Clear(with_hessian);
    for (Eigen::Index begin = 0; begin < t.size(); begin += kLanes) {
      FitEquations<10>::Jacobian jacobian{};
      Floats residual = AllLanes(1e6);  // what is missing of the last group does not count
      for (int lane = 0; lane < std::min<Eigen::Index>(kLanes, t.size() - begin); ++lane) {
        const double x = t[begin + lane], decay = std::exp(p[1] * x);
        jacobian[0][lane] = static_cast<float>(decay);
        jacobian[1][lane] = static_cast<float>(p[0] * x * decay);
        residual[lane] = static_cast<float>(p[0] * decay - y[begin + lane]);
      }
      equations->Add(&jacobian, residual, static_cast<int>(t.size() - begin));
    }
    equations->Finish(p - mean, weight);
  }
  Vector Plus(const Vector& p, const Vector& step) const { return p + step; }
  double StepSize(const Vector& step, const FitEquations<10>&) const {
    return step.head<2>().cwiseAbs().maxCoeff();
  }
  Vector LimitStep(const Vector&, const Vector& step) const { return step; }
  void Predict(const Vector& step, FitEquations<10>* equations) const { equations->Predict(step); }
};

TEST(FitEquations, AreTheSumsOverAllObservations) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  constexpr int kNumObservations = kLanes * 70 + 3;
  Eigen::Matrix<double, Eigen::Dynamic, 20> jacobians(kNumObservations, 20);
  Eigen::VectorXd residuals(kNumObservations);
  for (auto& value : jacobians.reshaped()) value = static_cast<float>(normal(random));
  for (double& value : residuals) value = static_cast<float>(normal(random));
  FitEquations<20> equations;
  equations.Clear(true);
  for (int begin = 0; begin < kNumObservations; begin += kLanes) {
    FitEquations<20>::Jacobian jacobian{};
    Floats residual = AllLanes(7);
    for (Floats& derivative : jacobian) derivative = AllLanes(5);
    for (int lane = 0; lane < kLanes && begin + lane < kNumObservations; ++lane) {
      for (int i = 0; i < 20; ++i) {
        jacobian[static_cast<std::size_t>(i)][lane] =
            static_cast<float>(jacobians(begin + lane, i));
      }
      residual[lane] = static_cast<float>(residuals[begin + lane]);
    }
    equations.Add(&jacobian, residual, kNumObservations - begin);
  }
  const FitEquations<20>::Vector departure = FitEquations<20>::Vector::LinSpaced(0, 1);
  const FitEquations<20>::Vector weight = FitEquations<20>::Vector::LinSpaced(1, 3);
  equations.Finish(departure, weight);
  Eigen::MatrixXd hessian = jacobians.transpose() * jacobians;
  hessian.diagonal() += weight;
  EXPECT_EQ(equations.num_observations(), kNumObservations);
  EXPECT_LT((equations.hessian() - hessian).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT(
      (equations.gradient() - jacobians.transpose() * residuals - weight.cwiseProduct(departure))
          .cwiseAbs()
          .maxCoeff(),
      1e-3);
  EXPECT_NEAR(equations.squared_residuals(), residuals.squaredNorm(), 1e-3);
  EXPECT_NEAR(equations.cost(),
              residuals.squaredNorm() + departure.cwiseAbs2().cwiseProduct(weight).sum(), 1e-3);
  const FitEquations<20>::Vector step = FitEquations<20>::Vector::LinSpaced(-0.1, 0.1);
  equations.Predict(step);
  EXPECT_NEAR(equations.squared_residuals(), (residuals + jacobians * step).squaredNorm(), 1e-2);
}

TEST(FitEquations, MinimizeSquaresFindsTheMinimumWithFewEvaluations) {
  const Decay decay(41);
  Vector parameters = Vector::Zero();
  parameters[0] = 1.0;
  FitEquations<10> equations;
  LeastSquaresOptions options;
  options.initial_damping = 1e-3;
  options.min_step = 1e-4;
  options.min_step_for_new_hessian = 0.02;
  EXPECT_EQ(MinimizeSquares(options, decay, &parameters, &equations), Convergence::kConverged);
  EXPECT_NEAR(parameters[0], 3.0, 1e-4);
  EXPECT_NEAR(parameters[1], -0.7, 1e-4);
  EXPECT_LT(equations.Rms(), 1e-4);
  EXPECT_LT(decay.num_evaluations, 15);
}

TEST(LimitParameter, ShortensOnlyStepsThatLeaveTheLimits) {
  for (const auto& [step, limited] : {std::pair(0.1, 0.1), {0.6, 0.5}, {-2.0, -0.5}}) {
    double shortened = step;
    LimitParameter(1.0, 2.0, 1.5, &shortened);
    EXPECT_EQ(shortened, limited);
  }
}

}  // namespace
}  // namespace velamap
