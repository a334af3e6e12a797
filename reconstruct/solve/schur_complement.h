// Ceres with a Schur complement, and the settings that the adjustments of this room share.

#pragma once

#include <vector>

#include <ceres/problem.h>

namespace velamap {

struct SchurOptions {
  int max_num_iterations = 50;
  // Ends when a step changes the cost by less than this fraction. Ceres discards that step;
  // `keeps_last_step` accepts it if it lowers the cost, for one more iteration.
  double function_tolerance = 1e-6;
  bool keeps_last_step = false;
  double initial_trust_region_radius = 1e4;
};

struct SchurSummary {
  bool is_usable = false;  // false: a residual cannot be evaluated, or no step can be computed
  int num_iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
};

// Minimizes over all parameter blocks that are not constant. These are `eliminated`, the blocks
// that the Schur complement eliminates (markers), no two of which may share a residual, and `kept`.
// If the result is not usable, all values stay as they are.
//
// The same input gives the same bytes if the eliminated blocks are elements of one array: Ceres
// orders them by address. It runs on one thread, because with several threads its elimination adds
// up results in the order in which they finish.
SchurSummary MinimizeBySchurComplement(const SchurOptions& options,
                                       const std::vector<double*>& eliminated,
                                       const std::vector<double*>& kept, ceres::Problem* problem);

}  // namespace velamap
