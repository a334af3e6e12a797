#include "importer/edge_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "importer/normal_table.h"

namespace velamap {
namespace {

using Vector = EdgeParameters::Vector;
using Matrix = Eigen::Matrix<double, EdgeParameters::kCount, EdgeParameters::kCount>;

constexpr double kMinBlurPx = 0.3;
constexpr double kMaxBlurPx = 5.0;
constexpr int kMaxIterations = 8;
constexpr double kPixelNoise = 3.0;  // grey levels, against which the priors weigh

struct NormalEquations {
  Matrix hessian = Matrix::Zero();
  Vector gradient = Vector::Zero();
  double cost = 0.0;
  double squared_residuals = 0.0;
};

Vector PriorWeight(const EdgePrior& prior) {
  return (kPixelNoise * prior.sigma.values.cwiseInverse()).cwiseAbs2();
}

NormalEquations Accumulate(const EdgeSamples& samples, const EdgePrior& prior,
                           const EdgeParameters& parameters) {
  NormalEquations equations;
  Vector jacobian;
  for (int i = 0; i < samples.count; ++i) {
    const EdgeSample& sample = samples.values[static_cast<std::size_t>(i)];
    const double residual = EvaluateEdge(parameters, sample, &jacobian) - sample.gray;
    equations.squared_residuals += residual * residual;
    equations.hessian.noalias() += jacobian * jacobian.transpose();
    equations.gradient += residual * jacobian;
  }
  const Vector weight = PriorWeight(prior);
  const Vector departure = parameters.values - prior.mean.values;
  equations.hessian.diagonal() += weight;
  equations.gradient += weight.cwiseProduct(departure);
  equations.cost = equations.squared_residuals + departure.cwiseAbs2().cwiseProduct(weight).sum();
  return equations;
}

}  // namespace

double EvaluateEdge(const EdgeParameters& p, const EdgeSample& sample, Vector* jacobian) {
  const double s = sample.s, hump = 1 - s * s;
  const double dark = p[EdgeParameters::kDark] + p[EdgeParameters::kDarkSlope] * s;
  const double light = p[EdgeParameters::kLight] + p[EdgeParameters::kLightSlope] * s;
  const double inverse_blur = 1 / p[EdgeParameters::kBlur];
  const double distance = sample.distance_px - p[EdgeParameters::kOffset] -
                          p[EdgeParameters::kSlope] * s - p[EdgeParameters::kBend] * hump;
  const double z = distance * inverse_blur;
  const double inner_z = (distance + sample.inner_depth_px) * inverse_blur;
  const double outer_z = (distance - sample.outer_depth_px) * inverse_blur;
  const NormalTable::Value edge = kNormalTable.At(z), inner = kNormalTable.At(inner_z),
                           outer = kNormalTable.At(outer_z);

  const double darkness = sample.cover * (1 - edge.distribution);
  const double inner_amount = sample.inner * (1 - inner.distribution);
  const double outer_amount = sample.outer * outer.distribution;
  const double by_edge = (light - dark) * sample.cover * edge.density;
  const double by_inner = -p[EdgeParameters::kInnerGain] * sample.inner * inner.density;
  const double by_outer = p[EdgeParameters::kOuterGain] * sample.outer * outer.density;
  const double by_offset = -(by_edge + by_inner + by_outer) * inverse_blur;
  *jacobian << by_offset, by_offset * s, by_offset * hump,
      -(by_edge * z + by_inner * inner_z + by_outer * outer_z) * inverse_blur, darkness,
      1 - darkness, darkness * s, (1 - darkness) * s, inner_amount, outer_amount;
  return light - (light - dark) * darkness + p[EdgeParameters::kInnerGain] * inner_amount +
         p[EdgeParameters::kOuterGain] * outer_amount;
}

std::optional<EdgeFit> FitEdge(const EdgeSamples& samples, const EdgePrior& prior,
                               double tolerance_px) {
  if (samples.count < EdgeParameters::kCount) return std::nullopt;
  EdgeParameters parameters = prior.mean;
  NormalEquations equations = Accumulate(samples, prior, parameters);
  double damping = 1e-4;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Matrix damped = equations.hessian;
    damped.diagonal() *= 1 + damping;
    const Vector step = -damped.ldlt().solve(equations.gradient);
    if (!step.allFinite()) return std::nullopt;
    EdgeParameters candidate{parameters.values + step};
    double& blur = candidate[EdgeParameters::kBlur];
    blur = std::clamp(blur, kMinBlurPx, kMaxBlurPx);
    const NormalEquations next = Accumulate(samples, prior, candidate);
    if (next.cost < equations.cost) {
      parameters = candidate;
      equations = next;
      damping *= 0.1;
    } else {
      damping *= 10;
    }
    if (step.head<3>().cwiseAbs().maxCoeff() < tolerance_px) break;
  }
  return EdgeFit{parameters, std::sqrt(equations.squared_residuals / samples.count)};
}

std::optional<EdgeUncertainty> EstimateUncertainty(const EdgeSamples& samples,
                                                   const EdgePrior& prior,
                                                   const EdgeParameters& parameters) {
  const Matrix hessian = Accumulate(samples, prior, parameters).hessian;
  const Matrix inverse = hessian.ldlt().solve(Matrix::Identity());
  if (!inverse.allFinite()) return std::nullopt;
  Matrix observed = hessian;
  observed.diagonal() -= PriorWeight(prior);
  EdgeUncertainty uncertainty;
  uncertainty.place_covariance =
      (inverse.topRows<2>() * observed * inverse.topRows<2>().transpose()).eval();
  Vector jacobian;
  for (int i = 0; i < samples.count; ++i) {
    const EdgeSample& sample = samples.values[static_cast<std::size_t>(i)];
    const double residual = EvaluateEdge(parameters, sample, &jacobian) - sample.gray;
    const double slope = jacobian[EdgeParameters::kOffset];
    uncertainty.noise.Add(slope * slope, residual, jacobian.dot(inverse * jacobian));
  }
  return uncertainty;
}

}  // namespace velamap
