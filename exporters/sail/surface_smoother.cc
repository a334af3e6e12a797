#include "exporters/sail/surface_smoother.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr int kPenaltyOrder = 3;
// Penalty over data term, as a ratio of traces. The lowest ratio interpolates to far below a
// micrometre. Each of the two penalties has to stay above it for the condition of the equations.
constexpr double kMinLog10Ratio = -9.0, kMaxLog10Ratio = 3.0;
constexpr double kCoarseStep = 1.0, kFineStep = 0.25;

// Integrals of the products of the derivatives of two basis functions.
Eigen::MatrixXd DerivativeProducts(const Eigen::ArrayXd& knots, int degree, int order) {
  const Eigen::Index num_poles = knots.size() - degree - 1;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(num_poles, num_poles);
  for (const QuadratureNode& node : SpanQuadrature(knots)) {
    const Eigen::VectorXd row =
        BasisRow(knots, degree, node.parameter, order).row(order).transpose();
    gram += node.weight * row * row.transpose();
  }
  return gram;
}

void AddKronecker(double factor, const Eigen::MatrixXd& left, const Eigen::MatrixXd& right,
                  Eigen::MatrixXd* sum) {
  for (Eigen::Index i = 0; i < left.rows(); ++i) {
    for (Eigen::Index k = 0; k < left.cols(); ++k) {
      sum->block(i * right.rows(), k * right.cols(), right.rows(), right.cols()) +=
          factor * left(i, k) * right;
    }
  }
}

// Integrals of the squared third derivatives, with u and v as lengths on the surface: S_uuu along
// the lines and S_vvv everywhere. S_uuu between the lines would flatten the profile there. A small
// share of it keeps single markers between the lines from making bumps.
struct Penalties {
  Eigen::MatrixXd along_u, along_v;
};

Penalties PenaltyMatrices(const SurfaceParameters& parameters) {
  const double between_lines = parameters.has_markers_between ? 1e-3 : 0.0;
  const auto gram_u = [&](int order) {
    return DerivativeProducts(parameters.knots_u, parameters.degree_u, order);
  };
  const auto gram_v = [&](int order) {
    return DerivativeProducts(parameters.knots_v, parameters.degree_v, order);
  };
  Eigen::MatrixXd over_lines = between_lines * gram_v(0);
  for (const double v : parameters.line_vs) {
    const Eigen::VectorXd row =
        BasisRow(parameters.knots_v, parameters.degree_v, v, 0).row(0).transpose();
    over_lines += row * row.transpose() / parameters.line_vs.size();
  }
  const double u_m = parameters.mean_length_u_m, v_m = parameters.length_v_m;
  const Eigen::Index num_poles = gram_u(0).rows() * over_lines.rows();
  Penalties penalties;
  penalties.along_u.setZero(num_poles, num_poles);
  penalties.along_v.setZero(num_poles, num_poles);
  AddKronecker(v_m / std::pow(u_m, 5), gram_u(kPenaltyOrder), over_lines, &penalties.along_u);
  AddKronecker(u_m / std::pow(v_m, 5), gram_u(0), gram_v(kPenaltyOrder), &penalties.along_v);
  return penalties;
}

// One row per observation: N_i(u) M_j(v) times the square root of the weight.
Eigen::MatrixXd DesignMatrix(const SurfaceParameters& parameters,
                             const std::vector<double>& weights) {
  const auto& observations = parameters.observations;
  Eigen::MatrixXd design;
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const Eigen::RowVectorXd row_u =
        BasisRow(parameters.knots_u, parameters.degree_u, observations[k].u, 0);
    const Eigen::RowVectorXd row_v =
        BasisRow(parameters.knots_v, parameters.degree_v, observations[k].v, 0);
    if (design.size() == 0) design.setZero(observations.size(), row_u.size() * row_v.size());
    for (Eigen::Index i = 0; i < row_u.size(); ++i) {
      design.block(k, i * row_v.size(), 1, row_v.size()) = std::sqrt(weights[k]) * row_u(i) * row_v;
    }
  }
  return design;
}

struct System {
  Eigen::MatrixXd design, normal;
  Penalties penalties;
  Eigen::MatrixX3d data;
};

struct Solution {
  Eigen::MatrixX3d poles;
  double trace = 0.0;  // of the hat matrix
};

Solution Solve(const System& system, double log10_ratio) {
  const double data_trace = system.normal.trace();
  const double trace_u = system.penalties.along_u.trace();
  const double trace_v = system.penalties.along_v.trace();  // 0 for two or three lines
  const double lambda = std::pow(10, log10_ratio) * data_trace / (trace_u + trace_v);
  const double smallest = std::pow(10, kMinLog10Ratio) * data_trace;
  const double lambda_u = std::max(lambda, smallest / trace_u);
  const double lambda_v = trace_v > 0 ? std::max(lambda, smallest / trace_v) : 0.0;
  const Eigen::MatrixXd penalty =
      lambda_u * system.penalties.along_u + lambda_v * system.penalties.along_v;
  const Eigen::LLT<Eigen::MatrixXd> factor(system.normal + penalty);
  if (factor.info() != Eigen::Success) {
    throw DataError("the equations of the surface are too badly conditioned to be solved");
  }
  Solution solution;
  solution.poles = Eigen::MatrixX3d::Zero(penalty.rows(), 3);
  // Iterative refinement restores the digits that the normal equations lose for poles that hardly
  // any marker determines.
  for (int step = 0; step < 4; ++step) {
    solution.poles +=
        factor.solve(system.design.transpose() * (system.data - system.design * solution.poles) -
                     penalty * solution.poles);
  }
  solution.trace = factor.matrixL().solve(system.design.transpose()).squaredNorm();
  return solution;
}

SplineSurface MakeSurface(const SurfaceParameters& parameters, const Solution& solution) {
  return {parameters.degree_u, parameters.degree_v, parameters.knots_u, parameters.knots_v,
          solution.poles};
}

// Counts the error along the normal only, because chord length parameters absorb the noise along
// the line.
double NormalSquaredResiduals(const System& system, const Solution& solution,
                              const Eigen::MatrixX3d& normals) {
  const Eigen::MatrixX3d residuals = system.data - system.design * solution.poles;
  return residuals.cwiseProduct(normals).rowwise().sum().squaredNorm();
}

struct Choice {
  double log10_ratio = kMinLog10Ratio;
  Solution solution;
};

// The smoothing with the lowest score.
template <typename Score>
Choice Search(const System& system, const Score& score_of) {
  Choice best;
  double best_score = std::numeric_limits<double>::infinity();
  const auto search = [&](double first, double last, double step) {
    for (double ratio = first; ratio <= last; ratio += step) {
      Solution solution = Solve(system, ratio);
      const double score = score_of(solution);
      if (score >= best_score) continue;
      best_score = score;
      best = {ratio, std::move(solution)};
    }
  };
  search(kMinLog10Ratio, kMaxLog10Ratio, kCoarseStep);
  const double coarse = best.log10_ratio;
  search(coarse - 3 * kFineStep, coarse - kFineStep, kFineStep);
  search(coarse + kFineStep, coarse + 3 * kFineStep, kFineStep);
  return best;
}

}  // namespace

SmoothSurface SmoothObservations(const SurfaceParameters& parameters,
                                 const std::vector<double>& weights, Smoothing smoothing) {
  const std::size_t n = parameters.observations.size();
  VELAMAP_CHECK(weights.size() == n);
  System system;
  system.design = DesignMatrix(parameters, weights);
  system.normal = system.design.transpose() * system.design;
  system.penalties = PenaltyMatrices(parameters);
  system.data.resize(n, 3);
  for (std::size_t k = 0; k < n; ++k) {
    system.data.row(k) = std::sqrt(weights[k]) * parameters.observations[k].x_in_shape_m;
  }

  const Solution closest = Solve(system, kMinLog10Ratio);
  const SplineSurface interpolating = MakeSurface(parameters, closest);
  if (smoothing == Smoothing::kInterpolate) return {interpolating, closest.trace};
  Eigen::MatrixX3d normals(n, 3);
  for (std::size_t k = 0; k < n; ++k) {
    const SurfaceObservation& observation = parameters.observations[k];
    normals.row(k) = EvaluateJet(interpolating, observation.u, observation.v).normal;
  }
  const auto squares_of = [&](const Solution& solution) {
    return NormalSquaredResiduals(system, solution, normals);
  };
  const Choice validated = Search(system, [&](const Solution& solution) {
    const double free = n - solution.trace;
    return squares_of(solution) / (free * free);
  });
  if (smoothing == Smoothing::kCrossValidation) {
    return {MakeSurface(parameters, validated.solution), validated.solution.trace};
  }
  const Choice known = Search(
      system, [&](const Solution& solution) { return squares_of(solution) + 2 * solution.trace; });
  // Sigmas that are too small would make the surface oscillate between the markers.
  const bool is_known = n < kMinCrossValidated || known.log10_ratio > validated.log10_ratio;
  const Solution& best = is_known ? known.solution : validated.solution;
  return {MakeSurface(parameters, best), best.trace};
}

}  // namespace velamap
