// Checks the gradient of a problem of importer/geometry/least_squares.h against central differences
// of its cost along each component of a step.

#pragma once

#include <gtest/gtest.h>

#include "importer/geometry/least_squares.h"

namespace velamap {

// `tolerance` is relative to the norm of the gradient.
template <typename Problem>
void ExpectGradientOfCost(const Problem& problem, const typename Problem::Parameters& parameters,
                          double tolerance) {
  constexpr double kStep = 1e-6;
  using Step = typename Problem::Step;
  typename Problem::Equations equations;
  problem.Evaluate(parameters, true, &equations);
  const Step gradient = equations.gradient();
  ASSERT_TRUE(std::isfinite(equations.cost()));
  ASSERT_GT(gradient.norm(), 0.0);
  Step differences;
  for (Eigen::Index i = 0; i < differences.size(); ++i) {
    double cost[2];
    for (const int sign : {-1, 1}) {
      const Step step = sign * kStep * Step::Unit(i);
      problem.Evaluate(problem.Plus(parameters, step), true, &equations);
      cost[(sign + 1) / 2] = equations.cost();
    }
    differences[i] = (cost[1] - cost[0]) / (2 * kStep);
  }
  EXPECT_LT((gradient - differences).norm(), tolerance * gradient.norm())
      << gradient.transpose() << "\n"
      << differences.transpose();
}

}  // namespace velamap
