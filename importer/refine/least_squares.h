// Levenberg-Marquardt for the fits of a marker's corners (Nocedal and Wright, Numerical
// Optimization, chapter 10), made for few parameters and cheap observations.

#pragma once

#include <Eigen/Cholesky>

#include "importer/refine/fit_equations.h"

namespace velamap {

struct LeastSquaresOptions {
  int max_iterations = 10;
  double first_damping = 1e-3;
  // Both by what a step moves in px. The Hessian of the last step serves again after a short one.
  double tolerance_px = 0.02;
  double new_hessian_px = 0.02;
};

// `evaluate(parameters, with_hessian, equations)` sums up, `moved_px(step)` says how far a step
// moves what is looked for, `limit(&parameters)` keeps parameters where they make sense. Starts at
// `*parameters` and ends where a step is within the tolerance; that step is taken without looking:
// `*equations` has the Hessian and Jacobians from before it, and residuals as these predict them.
// False for too few observations or a singular system.
template <int kCount, typename Evaluate, typename MovedPx, typename Limit>
bool MinimizeSquares(const LeastSquaresOptions& options, const Evaluate& evaluate,
                     const MovedPx& moved_px, const Limit& limit,
                     Eigen::Matrix<double, kCount, 1>* parameters,
                     FitEquations<kCount>* equations) {
  using Vector = typename FitEquations<kCount>::Vector;
  using Matrix = typename FitEquations<kCount>::Matrix;
  evaluate(*parameters, true, equations);
  if (equations->num_observations() <= kCount) return false;
  double damping = options.first_damping;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    Matrix damped = equations->hessian();
    damped.diagonal() *= 1 + damping;
    const Eigen::LLT<Eigen::Ref<Matrix>> factors(damped);
    if (factors.info() != Eigen::Success) return false;
    const Vector step = -factors.solve(equations->gradient());
    if (!step.allFinite()) return false;
    Vector candidate = *parameters + step;
    limit(&candidate);
    const double moved = moved_px(step);
    if (moved < options.tolerance_px) {
      equations->Predict(candidate - *parameters);
      *parameters = candidate;
      return true;
    }
    const double cost = equations->cost();
    evaluate(candidate, moved > options.new_hessian_px, equations);
    if (equations->cost() < cost) {
      *parameters = candidate;
      damping *= 0.1;
    } else {
      evaluate(*parameters, true, equations);
      damping *= 10;
    }
  }
  return true;
}

}  // namespace velamap
