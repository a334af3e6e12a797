#include "reconstruct/solve/schur_complement.h"

#include <cmath>
#include <memory>

#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

namespace velamap {
namespace {

// Ceres discards a step whose gain is below its function_tolerance. This callback ends the
// minimization after such a step instead, so that the gain is kept.
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

// Columns of the Schur complement.
int NumKeptColumns(const ceres::Problem& problem, const std::vector<double*>& eliminated) {
  std::vector<double*> blocks;
  problem.GetParameterBlocks(&blocks);
  int count = 0;
  for (const double* block : blocks) {
    if (!problem.IsParameterBlockConstant(block)) count += problem.ParameterBlockTangentSize(block);
  }
  for (const double* block : eliminated) count -= problem.ParameterBlockTangentSize(block);
  return count;
}

}  // namespace

SchurSummary MinimizeBySchurComplement(const SchurOptions& options,
                                       const std::vector<double*>& eliminated,
                                       ceres::Problem* problem) {
  // Up to about 200 images a dense factorization takes no longer than a sparse one.
  constexpr int kMaxDenseColumns = 1200;
  ceres::Solver::Options solver;
  solver.linear_solver_type = NumKeptColumns(*problem, eliminated) <= kMaxDenseColumns
                                  ? ceres::DENSE_SCHUR
                                  : ceres::SPARSE_SCHUR;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  std::vector<double*> blocks;
  problem->GetParameterBlocks(&blocks);
  for (double* block : blocks) solver.linear_solver_ordering->AddElementToGroup(block, 1);
  for (double* block : eliminated) solver.linear_solver_ordering->AddElementToGroup(block, 0);
  solver.max_num_iterations = options.max_num_iterations;
  solver.initial_trust_region_radius = options.initial_trust_region_radius;
  solver.function_tolerance = 0.0;
  solver.gradient_tolerance = 1e-14;
  solver.parameter_tolerance = 1e-14;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  StopAfterSmallChange stop(options.function_tolerance);
  solver.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, problem, &summary);
  return {summary.IsSolutionUsable(), static_cast<int>(summary.iterations.size()) - 1,
          summary.initial_cost, summary.final_cost};
}

}  // namespace velamap
