#include "reconstruct/solve/schur_complement.h"

#include <cmath>
#include <memory>

#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

namespace velamap {
namespace {

// Ends the minimization after a step that changes the cost by less than the tolerance.
class StopAfterSmallChange : public ceres::IterationCallback {
 public:
  explicit StopAfterSmallChange(double tolerance) : tolerance_(tolerance) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    const bool has_candidate = iteration.iteration > 0 && iteration.step_is_valid;
    return has_candidate && std::abs(iteration.cost_change) <= tolerance_ * iteration.cost
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  double tolerance_;
};

}  // namespace

SchurSummary MinimizeBySchurComplement(const SchurOptions& options,
                                       const std::vector<double*>& eliminated,
                                       const std::vector<double*>& kept, ceres::Problem* problem) {
  // Up to about 200 images a dense factorization takes no longer than a sparse one.
  constexpr int kMaxDenseColumns = 1200;
  ceres::Solver::Options solver;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (double* block : eliminated) solver.linear_solver_ordering->AddElementToGroup(block, 0);
  int num_columns = 0, group = 0;
  for (double* block : kept) {
    solver.linear_solver_ordering->AddElementToGroup(block, ++group);
    num_columns += problem->ParameterBlockTangentSize(block);
  }
  solver.linear_solver_type =
      num_columns <= kMaxDenseColumns ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  solver.max_num_iterations = options.max_num_iterations;
  solver.initial_trust_region_radius = options.initial_trust_region_radius;
  solver.function_tolerance = options.keeps_last_step ? 0.0 : options.function_tolerance;
  solver.gradient_tolerance = 1e-14;
  solver.parameter_tolerance = 1e-14;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  StopAfterSmallChange stop(options.function_tolerance);
  if (options.keeps_last_step) solver.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, problem, &summary);
  return {summary.IsSolutionUsable(), static_cast<int>(summary.iterations.size()) - 1,
          summary.initial_cost, summary.final_cost};
}

}  // namespace velamap
