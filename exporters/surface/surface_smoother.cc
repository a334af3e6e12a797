#include "exporters/surface/surface_smoother.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <unsupported/Eigen/KroneckerProduct>

#include "importer/base/error.h"

namespace velamap {
namespace {

// The smallest weights interpolate to far below a micrometre and keep the equations solvable; the
// largest leave only parabolas, which the penalties do not affect.
constexpr double kMinWeight = -9.0, kMaxWeight = 4.0;
// An interpolating surface may bend more along the lines, which hold markers, than between them.
constexpr double kMinWeightAlongLines = -11.0;
constexpr SmoothingWeights kStiffest{kMaxWeight, kMaxWeight};
constexpr double kFirstStep = 1.0, kNearStep = 0.5, kLastStep = 0.25;
// Each effective parameter counts this many times, because the smoothing with the lowest score
// often follows the noise of few markers (Kim and Gu, "Smoothing spline Gaussian regression: more
// scalable computation via efficient approximation", 2004).
constexpr double kCostFactor = 1.4;

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

// Integrals of the squared third derivatives, with u and v as lengths on the surface: those that
// are mainly along the lines, S_uuu and S_uuv, and those mainly across them, S_uvv and S_vvv. A
// sail is bent more along its lines than across them, so each pair has its own weight.
struct Penalties {
  Eigen::MatrixXd along, across;
};

Penalties PenaltyMatrices(const SurfaceParameters& parameters) {
  const auto gram_u = [&](int order) {
    return DerivativeProducts(parameters.knots_u, parameters.degree_u, order);
  };
  const auto gram_v = [&](int order) {
    return DerivativeProducts(parameters.knots_v, parameters.degree_v, order);
  };
  const double u_m = parameters.mean_length_u_m, v_m = parameters.length_v_m;
  const auto product = [&](int order_u, int order_v) -> Eigen::MatrixXd {
    return Eigen::kroneckerProduct(gram_u(order_u), gram_v(order_v));
  };
  // A factor of 3, as in the square of the third differential, makes the sum of all four the same
  // in every direction of u and v.
  const double mixed = 3.0;
  return {
      v_m / std::pow(u_m, 5) * product(3, 0) + mixed / (std::pow(u_m, 3) * v_m) * product(2, 1),
      mixed / (u_m * std::pow(v_m, 3)) * product(1, 2) + u_m / std::pow(v_m, 5) * product(0, 3)};
}

// N_i(u) M_j(v) for all poles.
Eigen::RowVectorXd BasisAt(const Eigen::ArrayXd& knots_u, int degree_u,
                           const Eigen::ArrayXd& knots_v, int degree_v, double u, double v) {
  const Eigen::RowVectorXd row_u = BasisRow(knots_u, degree_u, u, 0);
  const Eigen::RowVectorXd row_v = BasisRow(knots_v, degree_v, v, 0);
  Eigen::RowVectorXd basis(row_u.size() * row_v.size());
  for (Eigen::Index i = 0; i < row_u.size(); ++i) {
    basis.segment(i * row_v.size(), row_v.size()) = row_u(i) * row_v;
  }
  return basis;
}

struct System {
  Eigen::MatrixXd design, normal;
  Eigen::MatrixXd root;  // root * root^T is the normal matrix
  Penalties penalties;
  Eigen::MatrixX3d data;
};

// One row of the design and the data per term, times the square root of its weight.
System MakeSystem(const SurfaceParameters& parameters, const std::vector<SurfaceTerm>& terms) {
  const Eigen::Index num_poles = (parameters.knots_u.size() - parameters.degree_u - 1) *
                                 (parameters.knots_v.size() - parameters.degree_v - 1);
  System system;
  system.design.setZero(terms.size(), num_poles);
  system.data.setZero(terms.size(), 3);
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const auto& points = parameters.observations[terms[k].observation_idx].points;
    VELAMAP_CHECK(terms[k].factors.size() == points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double factor = std::sqrt(terms[k].weight) * terms[k].factors[i];
      system.design.row(k) +=
          factor * BasisAt(parameters.knots_u, parameters.degree_u, parameters.knots_v,
                           parameters.degree_v, points[i].u, points[i].v);
      system.data.row(k) += factor * points[i].x_in_shape_m;
    }
  }
  system.normal = system.design.transpose() * system.design;
  system.root = system.design.transpose();
  if (system.root.cols() > num_poles) {
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(system.design);
    system.root = qr.matrixQR().topRows(num_poles).triangularView<Eigen::Upper>();
    system.root.transposeInPlace();
  }
  system.penalties = PenaltyMatrices(parameters);
  return system;
}

struct Solution {
  Eigen::MatrixX3d poles;
  double trace = 0.0;  // of the hat matrix
};

struct Equations {
  Eigen::MatrixXd penalty;
  Eigen::LLT<Eigen::MatrixXd> factor;
};

Equations MakeEquations(const System& system, const SmoothingWeights& weights) {
  const double data_trace = system.normal.trace();
  const auto weigh = [&](double weight, const Eigen::MatrixXd& penalty) -> Eigen::MatrixXd {
    const double trace = penalty.trace();  // 0 across two lines
    const double factor = trace > 0 ? std::pow(10, weight) * data_trace / trace : 0.0;
    return factor * penalty;
  };
  Equations equations;
  equations.penalty =
      weigh(weights.along, system.penalties.along) + weigh(weights.across, system.penalties.across);
  equations.factor.compute(system.normal + equations.penalty);
  if (equations.factor.info() != Eigen::Success) {
    throw DataError("the equations of the surface are too badly conditioned to be solved");
  }
  return equations;
}

Solution Solve(const System& system, const SmoothingWeights& weights) {
  const auto [penalty, factor] = MakeEquations(system, weights);
  Solution solution;
  solution.poles = Eigen::MatrixX3d::Zero(penalty.rows(), 3);
  // Iterative refinement restores the digits that the normal equations lose for poles that hardly
  // any marker determines.
  for (int step = 0; step < 4; ++step) {
    solution.poles +=
        factor.solve(system.design.transpose() * (system.data - system.design * solution.poles) -
                     penalty * solution.poles);
  }
  solution.trace = factor.matrixL().solve(system.root).squaredNorm();
  return solution;
}

SplineSurface MakeSurface(const SurfaceParameters& parameters, const Solution& solution) {
  return {parameters.degree_u, parameters.degree_v, parameters.knots_u, parameters.knots_v,
          solution.poles};
}

// Counts the error along the normal only: along the surface, a marker may lie anywhere.
Eigen::VectorXd NormalResiduals(const System& system, const Solution& solution,
                                const Eigen::MatrixX3d& normals) {
  const Eigen::MatrixX3d residuals = system.data - system.design * solution.poles;
  return residuals.cwiseProduct(normals).rowwise().sum();
}

// Sets the covariance of the poles and its parts. `variance` is that of a term of weight 1.
void AddUncertainty(const System& system, const std::vector<SurfaceTerm>& terms,
                    const SmoothingWeights& weights, double variance, SmoothSurface* smooth) {
  const auto [penalty, factor] = MakeEquations(system, weights);
  const Eigen::MatrixXd inverse =
      factor.solve(Eigen::MatrixXd::Identity(penalty.rows(), penalty.rows()));
  smooth->pole_covariance_m2 = variance * inverse;
  smooth->smoothing_covariance_m2 = variance * inverse * penalty * inverse;
  smooth->pole_by_term = factor.solve(system.design.transpose());
  smooth->leverages = system.design.cwiseProduct(smooth->pole_by_term.transpose()).rowwise().sum();
  for (std::size_t k = 0; k < terms.size(); ++k) {
    smooth->pole_by_term.col(k) *= std::sqrt(terms[k].weight);
  }
}

struct Choice {
  Solution solution;
  double score = std::numeric_limits<double>::infinity();
  SmoothingWeights weights = kStiffest;
};

// The weights with the lowest score, by a pattern search (Hooke and Jeeves, 1961) from `near` or
// from the best pair of equal weights. `parabolic` is the solution of the stiffest ones.
template <typename Score>
Choice Search(const System& system, const Solution& parabolic,
              const std::optional<SmoothingWeights>& near, const Score& score_of) {
  Choice best;
  best.solution = parabolic;  // kept if too few observations give a score
  const auto is_better = [&](const SmoothingWeights& weights, Solution solution) {
    const double score = score_of(solution);
    if (!(score < best.score)) return false;
    best = {std::move(solution), score, weights};
    return true;
  };
  const auto improves = [&](const SmoothingWeights& weights) {
    return std::min(weights.along, weights.across) >= kMinWeight &&
           std::max(weights.along, weights.across) <= kMaxWeight &&
           is_better(weights, Solve(system, weights));
  };
  if (near) {
    improves(*near);
  } else {
    is_better(kStiffest, parabolic);
    for (double weight = kMaxWeight - kFirstStep; weight >= kMinWeight; weight -= kFirstStep) {
      improves({weight, weight});
    }
  }
  for (double step = near ? kNearStep : kFirstStep; step >= kLastStep; step /= 2) {
    bool moved = true;
    while (moved) {
      const SmoothingWeights center = best.weights;
      moved = improves({center.along + step, center.across}) ||
              improves({center.along - step, center.across}) ||
              improves({center.along, center.across + step}) ||
              improves({center.along, center.across - step});
    }
  }
  return best;
}

}  // namespace

SmoothSurface SmoothTerms(const SurfaceParameters& parameters,
                          const std::vector<SurfaceTerm>& terms, Smoothing smoothing,
                          const std::optional<SmoothingWeights>& near) {
  const std::size_t n = terms.size();
  const System system = MakeSystem(parameters, terms);
  SmoothSurface smooth;
  if (smoothing == Smoothing::kInterpolate) {
    const Solution closest = Solve(system, {kMinWeightAlongLines, kMinWeight});
    smooth.surface = MakeSurface(parameters, closest);
    smooth.num_effective_parameters = closest.trace;
    return smooth;
  }
  const Solution parabolic = Solve(system, kStiffest);
  smooth.surface = MakeSurface(parameters, parabolic);
  smooth.num_effective_parameters = parabolic.trace;
  if (smoothing == Smoothing::kParabolas) return smooth;
  Eigen::MatrixX3d normals(n, 3);
  for (std::size_t k = 0; k < n; ++k) {
    const SurfaceObservation& observation = parameters.observations[terms[k].observation_idx];
    normals.row(k) = EvaluateJet(smooth.surface, observation.u, observation.v).normal;
  }
  const auto squares_of = [&](const Solution& solution) {
    return NormalResiduals(system, solution, normals).squaredNorm();
  };
  const Choice chosen = Search(system, parabolic, near, [&](const Solution& solution) {
    if (smoothing == Smoothing::kKnownSigma) {
      return squares_of(solution) + 2 * kCostFactor * solution.trace;
    }
    const double free = n - kCostFactor * solution.trace;
    return free > 0 ? squares_of(solution) / (free * free)
                    : std::numeric_limits<double>::infinity();
  });
  const double free = n - chosen.solution.trace;
  smooth.residuals = NormalResiduals(system, chosen.solution, normals);
  const double variance = smoothing == Smoothing::kKnownSigma
                              ? 1.0
                              : smooth.residuals.squaredNorm() / std::max(free, 1.0);
  smooth.surface = MakeSurface(parameters, chosen.solution);
  smooth.weights = chosen.weights;
  smooth.num_effective_parameters = chosen.solution.trace;
  AddUncertainty(system, terms, chosen.weights, variance, &smooth);
  return smooth;
}

Eigen::RowVectorXd PoleShares(const SplineSurface& surface, double u, double v) {
  return BasisAt(surface.knots_u, surface.degree_u, surface.knots_v, surface.degree_v, u, v);
}

std::optional<double> SigmaAt(const SplineSurface& surface,
                              const Eigen::MatrixXd& pole_covariance_m2, double u, double v) {
  if (pole_covariance_m2.size() == 0) return std::nullopt;
  const Eigen::RowVectorXd basis = PoleShares(surface, u, v);
  return std::sqrt(std::max(0.0, basis.dot(basis * pole_covariance_m2)));
}

}  // namespace velamap
