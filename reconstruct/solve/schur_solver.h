// Levenberg-Marquardt for a SchurProblem, with the steps, tolerances and damping of Ceres's
// trust-region minimiser (Madsen, Nielsen, Tingleff 2004; the diagonal scaled as in Ceres), but for
// one thing: a last step that lowers the cost is taken, not thrown away. One thread, sums in the
// order of the blocks: same input, same bytes.

#pragma once

#include "reconstruct/solve/schur_problem.h"

namespace velamap {

struct SchurSolverOptions {
  int max_num_iterations = 50;
  // Ends where a step changes the cost by less than this part of it,
  double function_tolerance = 1e-6;
  // or the parameters by less than this part of their norm,
  double parameter_tolerance = 1e-14;
  // or no derivative is larger than this.
  double gradient_tolerance = 0.0;
  // Ceres's initial_trust_region_radius.
  double initial_radius = 1e4;
};

struct SchurSummary {
  bool is_usable = false;  // false: the residuals cannot be evaluated, or no step can be computed
  int num_iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
};

// Moves the values that the blocks point at; where it is not usable they are untouched.
SchurSummary SolveSchur(const SchurSolverOptions& options, const SchurProblem& problem);

}  // namespace velamap
