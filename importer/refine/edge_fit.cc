#include "importer/refine/edge_fit.h"

#include <Eigen/Cholesky>

#include "importer/detect/gray_levels.h"
#include "importer/geometry/least_squares.h"
#include "importer/lanes/normal_lanes.h"

namespace velamap {
namespace {

using EdgeVector = EdgeParameters::Vector;
using EdgeMatrix = EdgeEquations::Matrix;

constexpr double kMinEdgeBlurPx = 0.3;
constexpr double kMaxEdgeBlurPx = 5.0;

EdgeVector PriorWeight(const EdgePrior& prior) {
  return (kPixelNoise * prior.sigma.values.cwiseInverse()).cwiseAbs2();
}

VELAMAP_CLONE_FOR_AVX2 void SumUp(const EdgeSamples& samples, const EdgePrior& prior,
                                  const EdgeVector& weight, const EdgeVector& values,
                                  bool with_hessian, EdgeEquations* equations) {
  const EdgeParameters parameters{values};
  equations->Clear(with_hessian);
  EdgeEquations::Jacobian jacobian;
  for (int i = 0; i < samples.count; i += kLanes) {
    const EdgeSampleGroup& group = samples.groups[static_cast<std::size_t>(i / kLanes)];
    const Floats modelled = EvaluateEdge(parameters, group, &jacobian);
    equations->Add(&jacobian, modelled - group.gray, samples.count - i);
  }
  equations->Finish(values - prior.mean.values, weight);
}

// The fit as a problem of MinimizeSquares().
struct EdgeProblem {
  using Parameters = EdgeVector;
  using Equations = EdgeEquations;
  using Step = EdgeVector;

  const EdgeSamples& samples;
  const EdgePrior& prior;
  EdgeVector prior_weight;

  void Evaluate(const EdgeVector& values, bool with_hessian, EdgeEquations* equations) const {
    SumUp(samples, prior, prior_weight, values, with_hessian, equations);
  }
  EdgeVector Plus(const EdgeVector& values, const EdgeVector& step) const { return values + step; }
  // How far the edge moves, px.
  double StepSize(const EdgeVector& step, const EdgeEquations&) const {
    return step.head<3>().cwiseAbs().maxCoeff();
  }
  EdgeVector LimitStep(const EdgeVector& values, EdgeVector step) const {
    LimitParameter(kMinEdgeBlurPx, kMaxEdgeBlurPx, values[EdgeParameters::kBlur],
                   &step[EdgeParameters::kBlur]);
    return step;
  }
  void Predict(const EdgeVector& step, EdgeEquations* equations) const { equations->Predict(step); }
};

// `inverse` of the Hessian.
VELAMAP_CLONE_FOR_AVX2 ResidualNoise NoiseOf(const EdgeEquations& equations,
                                             const EdgeMatrix& inverse) {
  return equations.Noise(inverse, [](const EdgeEquations::Jacobian& jacobian) {
    return jacobian[EdgeParameters::kOffset] * jacobian[EdgeParameters::kOffset];
  });
}

}  // namespace

Floats EvaluateEdge(const EdgeParameters& parameters, const EdgeSampleGroup& samples,
                    EdgeEquations::Jacobian* jacobian) {
  using E = EdgeParameters;
  const Eigen::Matrix<float, E::kCount, 1> p = parameters.values.cast<float>();
  const Floats s = samples.s, hump = 1.0f - s * s;
  const Floats dark = p[E::kDark] + p[E::kDarkSlope] * s;
  const Floats light = p[E::kLight] + p[E::kLightSlope] * s;
  const float inverse_blur = 1 / p[E::kBlur];
  const Floats distance =
      samples.distance_px - p[E::kOffset] - p[E::kSlope] * s - p[E::kBend] * hump;
  const Floats z = distance * inverse_blur;
  const Floats inner_z = (distance + samples.inner_depth_px) * inverse_blur;
  const Floats outer_z = (distance - samples.outer_depth_px) * inverse_blur;
  const NormalLanes edge = NormalAt(z), inner = NormalAt(inner_z), outer = NormalAt(outer_z);

  const Floats darkness = samples.cover * (1.0f - edge.distribution);
  const Floats inner_amount = samples.inner * (1.0f - inner.distribution);
  const Floats outer_amount = samples.outer * outer.distribution;
  const Floats by_edge = (light - dark) * samples.cover * edge.density;
  const Floats by_inner = -p[E::kInnerGain] * samples.inner * inner.density;
  const Floats by_outer = p[E::kOuterGain] * samples.outer * outer.density;
  const Floats by_offset = -(by_edge + by_inner + by_outer) * inverse_blur;
  *jacobian = {
      by_offset,        by_offset * s,
      by_offset * hump, -(by_edge * z + by_inner * inner_z + by_outer * outer_z) * inverse_blur,
      darkness,         1.0f - darkness,
      darkness * s,     (1.0f - darkness) * s,
      inner_amount,     outer_amount};
  return light - (light - dark) * darkness + p[E::kInnerGain] * inner_amount +
         p[E::kOuterGain] * outer_amount;
}

bool FitEdge(const EdgeSamples& samples, const EdgePrior& prior, double tolerance_px,
             EdgeFit* fit) {
  if (samples.count <= EdgeParameters::kCount) return false;
  LeastSquaresOptions options;
  options.max_iterations = 8;
  options.min_step = tolerance_px;
  options.min_step_for_new_hessian = 0.02;
  fit->parameters = prior.mean;
  return MinimizeSquares(options, EdgeProblem{samples, prior, PriorWeight(prior)},
                         &fit->parameters.values, &fit->equations) != Convergence::kFailed;
}

std::optional<EdgeUncertainty> EstimateUncertainty(const EdgeFit& fit, const EdgePrior& prior) {
  const Eigen::LLT<EdgeMatrix> factors(fit.equations.hessian());
  if (factors.info() != Eigen::Success) return std::nullopt;
  const EdgeMatrix inverse = factors.solve(EdgeMatrix::Identity());
  if (!inverse.allFinite()) return std::nullopt;
  EdgeUncertainty uncertainty;
  // inverse * (hessian - weight) * inverse, of the first two parameters.
  const auto place = inverse.leftCols<2>();
  uncertainty.place_covariance =
      inverse.topLeftCorner<2, 2>() -
      place.transpose().lazyProduct(PriorWeight(prior).asDiagonal() * place);
  uncertainty.noise = NoiseOf(fit.equations, inverse);
  return uncertainty;
}

}  // namespace velamap
