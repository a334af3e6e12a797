// Levenberg-Marquardt for nonlinear least squares with few parameters (Nocedal and Wright,
// Numerical Optimization, 2nd edition, section 10.3). The loop knows nothing of residuals: a
// problem evaluates them, sums up their normal equations and applies a step to its parameters.

#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Core>

namespace velamap {

// Loss functions rho(s) of the squared length s of a residual, as in Ceres; Weight(s) is the
// derivative, which weights the residual in the normal equations.
struct TrivialLoss {
  double Value(double s) const { return s; }
  double Weight(double) const { return 1.0; }
};

struct CauchyLoss {
  double squared_scale = 1.0;  // residuals with s beyond it lose weight

  double Value(double s) const { return squared_scale * std::log1p(s / squared_scale); }
  double Weight(double s) const { return 1 / (1 + s / squared_scale); }
};

// The normal equations of N parameters: the sums of J^T J, of J^T r and of half the squared
// residuals.
template <int N>
class GaussNewtonEquations {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  template <int R, typename Loss = TrivialLoss>
  void Add(const Eigen::Matrix<double, R, N>& jacobian, const Eigen::Matrix<double, R, 1>& residual,
           const Loss& loss = {}) {
    const double squared = residual.squaredNorm(), weight = loss.Weight(squared);
    const Eigen::Matrix<double, N, R> weighted = weight * jacobian.transpose();
    hessian_ += weighted.lazyProduct(jacobian);
    gradient_ += weighted.lazyProduct(residual);
    cost_ += 0.5 * loss.Value(squared);
  }

  // Regularizes directions that the residuals leave open.
  void AddToDiagonal(double value) { hessian_.diagonal().array() += value; }

  // Makes the parameters inadmissible, such as a pose that puts a point behind the camera.
  void Reject() { cost_ = std::numeric_limits<double>::infinity(); }

  const Matrix& hessian() const { return hessian_; }
  const Vector& gradient() const { return gradient_; }
  double cost() const { return cost_; }

 private:
  Matrix hessian_ = Matrix::Zero();
  Vector gradient_ = Vector::Zero();
  double cost_ = 0.0;
};

struct LeastSquaresOptions {
  int max_iterations = 20;
  // As a fraction of the Hessian's diagonal. It is divided by ten after a step that lowers the
  // cost, multiplied by ten after one that does not, and ends the search beyond the maximum.
  double initial_damping = 1e-4;
  double max_damping = 1e6;
  // A step smaller than this, as the problem measures it, is taken without an evaluation and ends
  // the search.
  double min_step = 0.0;
  // After a step no larger than this the last Hessian is used again instead of being summed up.
  double min_step_for_new_hessian = 0.0;
  // A smaller relative decrease of the cost ends the search.
  double min_relative_decrease = 0.0;
};

enum class Convergence {
  kConverged,     // the last step or decrease was small enough
  kNotConverged,  // out of iterations, or no step lowers the cost
  kFailed,        // nothing to start from, or every system was singular
};

// Base of a problem of N parameters, with defaults for what most problems have in common.
template <int N>
struct LeastSquaresProblem {
  using Equations = GaussNewtonEquations<N>;
  using Step = typename Equations::Vector;

  double StepSize(const Step& step, const Equations&) const { return step.norm(); }
  template <typename Parameters>
  Step LimitStep(const Parameters&, const Step& step) const {
    return step;
  }
  // Called instead of Evaluate() for a final step below min_step.
  void Predict(const Step&, Equations*) const {}
};

// Replaces the right side `solution` by the solution, and `matrix` by its factor. Returns whether
// the matrix is positive definite and the solution finite. One function for all numbers of
// parameters, because Eigen's solvers of fixed sizes take long to compile.
bool SolveInPlace(Eigen::Ref<Eigen::MatrixXd> matrix, Eigen::Ref<Eigen::VectorXd> solution);

// The step that solves the damped equations; nothing for a singular system.
template <typename Equations>
std::optional<typename Equations::Vector> SolveDamped(const Equations& equations, double damping) {
  typename Equations::Matrix damped = equations.hessian();
  damped.diagonal() *= 1 + damping;
  typename Equations::Vector step = -equations.gradient();
  if (!SolveInPlace(damped, step)) return std::nullopt;
  return step;
}

// Starts at `*parameters` and leaves the best found there. A Problem has
//   Parameters, Equations, Step                    types (see LeastSquaresProblem)
//   Evaluate(parameters, with_hessian, equations)  sums up; without the Hessian the old one stays
//   Plus(parameters, step)                         the parameters after a step
//   StepSize, LimitStep, Predict                   see LeastSquaresProblem
// `*equations` come from the last evaluation, which was at `*parameters` except for a last small
// step.
template <typename Problem>
Convergence MinimizeSquares(const LeastSquaresOptions& options, const Problem& problem,
                            typename Problem::Parameters* parameters,
                            typename Problem::Equations* equations) {
  problem.Evaluate(*parameters, true, equations);
  double cost = equations->cost(), damping = options.initial_damping;
  if (!std::isfinite(cost)) return Convergence::kFailed;
  bool has_solved = false;
  for (int i = 0; i < options.max_iterations && damping <= options.max_damping; ++i) {
    const auto solution = SolveDamped(*equations, damping);
    if (!solution) {
      damping *= 10;
      continue;
    }
    has_solved = true;
    const double step_size = problem.StepSize(*solution, *equations);
    const typename Problem::Step step = problem.LimitStep(*parameters, *solution);
    const typename Problem::Parameters candidate = problem.Plus(*parameters, step);
    if (step_size < options.min_step) {
      problem.Predict(step, equations);
      *parameters = candidate;
      return Convergence::kConverged;
    }
    problem.Evaluate(candidate, step_size > options.min_step_for_new_hessian, equations);
    if (equations->cost() < cost) {
      const bool is_small = cost - equations->cost() < options.min_relative_decrease * cost;
      *parameters = candidate;
      cost = equations->cost();
      damping *= 0.1;
      if (is_small) return Convergence::kConverged;
    } else {
      problem.Evaluate(*parameters, true, equations);
      damping *= 10;
    }
  }
  return has_solved ? Convergence::kNotConverged : Convergence::kFailed;
}

}  // namespace velamap
