// Ceres with a Schur complement, and the settings that the adjustments of this room share.

#pragma once

#include <vector>

#include <ceres/problem.h>

namespace velamap {

struct SchurOptions {
  int max_num_iterations = 50;
  // A step that changes the cost by less than this fraction is the last one.
  double function_tolerance = 1e-6;
  double initial_trust_region_radius = 1e4;
};

struct SchurSummary {
  bool is_usable = false;  // false: a residual cannot be evaluated, or no step can be computed
  int num_iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
};

// Minimizes over all parameter blocks that are not constant. `eliminated` are the blocks that the
// Schur complement eliminates (markers); no two of them may share a residual. Where the result is
// not usable, all values stay as they are.
//
// Ceres runs on one thread: with several, its elimination sums in the order in which they finish,
// and the last digits of the result change from run to run.
SchurSummary MinimizeBySchurComplement(const SchurOptions& options,
                                       const std::vector<double*>& eliminated,
                                       ceres::Problem* problem);

}  // namespace velamap
