#include "importer/formation/formation_problem.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

constexpr int kCount = kNumFormationParameters;
using State = FormationState;
using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, kCount>;

// Blur, demosaicing, filters and compression correlate the errors of neighbouring pixels: about
// this many of them are worth one independent pixel. With full weight, they would overrule the
// priors.
constexpr double kPixelsAlike = 10.0;

// The steps of the differences that stand for derivatives: the samples are fitted again after each
// step, and no automatic derivative passes through these fits.
const FormationVector kStep =
    (FormationVector() << 0.02, 0.004, 0.02, 0.04, 0.0004, 0.02, 0.01, 0.1).finished();

const std::vector<State>& MovedBySteps(const State& state, const FitWorkers& workers) {
  if (!state.moved) {
    std::vector<State> moved;
    for (int k = 0; k < kCount; ++k) {
      FormationVector parameters = state.parameters;
      parameters[k] += kStep[k];
      moved.push_back(MovedTo(parameters, state, workers));
    }
    state.moved = std::make_shared<const std::vector<State>>(std::move(moved));
  }
  return *state.moved;
}

// The root of the weight of the j-th residual of the i-th sample.
double RootWeight(const State& state, std::size_t i, Eigen::Index j) {
  const SamplePlace& place = state.samples[i].places[static_cast<std::size_t>(j)];
  return place.is_at_outline_corner ? std::sqrt(state.formation->parameters().outline_corner_weight)
                                    : 1.0;
}

// Derivatives of the residuals of the i-th sample; zero if a fit failed or jumped.
Jacobian JacobianOf(const State& state, const std::vector<State>& moved, std::size_t i) {
  const auto residuals_of = [i](const State& one) {
    const std::vector<float>& residuals = one.samples[i].residuals;
    return Eigen::Map<const Eigen::VectorXf>(residuals.data(),
                                             static_cast<Eigen::Index>(residuals.size()))
        .cast<double>();
  };
  Jacobian jacobian =
      Jacobian::Zero(static_cast<Eigen::Index>(state.samples[i].places.size()), kCount);
  const bool are_alike = std::all_of(moved.begin(), moved.end(), [&](const State& one) {
    return AreAlike(state.samples[i], one.samples[i]);
  });
  for (int k = 0; are_alike && k < kCount; ++k) {
    jacobian.col(k) =
        (residuals_of(moved[static_cast<std::size_t>(k)]) - residuals_of(state)) / kStep[k];
  }
  return jacobian;
}

// Limits the influence of single samples, because an occluded one says nothing about the others.
double VarianceOfSum(const std::vector<double>& influences) {
  constexpr double kSigmas = 4.0;
  if (influences.empty()) return 0.0;
  std::vector<double> sizes = influences;
  for (double& size : sizes) size = std::abs(size);
  const double limit = kSigmas * kMadToSigma * Median(sizes);
  double sum = 0.0;
  for (const double size : sizes) sum += std::min(size, limit) * std::min(size, limit);
  const double num = static_cast<double>(influences.size());
  return sum * num / std::max(1.0, num - kCount);
}

}  // namespace

FormationPriors PriorsFor(const std::vector<FormationSample>& samples) {
  constexpr double kInkSigma_mm = 0.1;
  constexpr double kMaxInkSpreadSides = 0.1;  // half of a cell of the coarsest markers
  std::vector<double> sides_mm;
  for (const FormationSample& sample : samples) sides_mm.push_back(sample.marker.side_mm);
  const double side_mm = Median(std::move(sides_mm));
  const double ink_sigma = kInkSigma_mm / side_mm;
  const double max_ink = std::min(kMaxInkSpread_mm / side_mm, kMaxInkSpreadSides);
  FormationPriors priors;
  priors.side_mm = side_mm;
  priors.mean << std::log(1.6), 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, std::log(2.7);
  priors.sigma << 0.6, 0.05, 0.5, 0.3, ink_sigma, 0.2, 0.05, 0.4;
  // The largest gammas stand for the logarithms of flat profiles and HDR video, which are the limit
  // of a power. A halo of less than 2 px is part of the blur. S is below zero if a camera lifts
  // shadows and holds back lights, as phones do.
  priors.min << std::log(0.8), -0.13, -0.3, std::log(0.5), -max_ink, -kMaxEdgeShift, -0.1,
      std::log(2.0);
  priors.max << std::log(8.0), 0.13, 2.0, std::log(2.5), max_ink, kMaxEdgeShift, 0.15,
      std::log(5.0);
  return priors;
}

FormationProblem::FormationProblem(const FormationPriors& priors, std::vector<double> noises,
                                   const FitWorkers& workers)
    : priors_(priors), noises_(std::move(noises)), workers_(workers) {}

void FormationProblem::Evaluate(const State& state, bool, Equations* equations) const {
  *equations = SumUp(state, false);
  if (equations->cost() > least_cost_) return;
  least_cost_ = equations->cost();
  *equations = SumUp(state, true);
}

State FormationProblem::Plus(const State& state, const Step& step) const {
  return MovedTo((state.parameters + step).cwiseMax(priors_.min).cwiseMin(priors_.max), state,
                 workers_);
}

double FormationProblem::Cost(const State& state) const { return SumUp(state, false).cost(); }

double FormationProblem::InsetSigma(const State& state) const {
  const std::vector<State>& moved = MovedBySteps(state, workers_);
  FormationVector inset_by;
  for (int k = 0; k < kCount; ++k) {
    inset_by[k] = MeanInset(state, moved[static_cast<std::size_t>(k)]) / kStep[k];
  }
  const FormationVector by_inset = SumUp(state, true).hessian().ldlt().solve(inset_by);
  const FormationVector by_prior =
      PriorWeight().cwiseAbs2().cwiseProduct(priors_.sigma).cwiseProduct(by_inset);
  return std::sqrt(std::max(VarianceOfSum(InfluencesOf(state, by_inset)) + by_prior.squaredNorm(),
                            inset_by.dot(by_inset)));
}

std::vector<double> FormationProblem::InfluencesOf(const State& state,
                                                   const FormationVector& by_inset) const {
  std::vector<double> influences;
  for (std::size_t i = 0; i < state.samples.size(); ++i) {
    Equations equations;
    AddSample(state, true, i, &equations);
    if (!equations.gradient().isZero(0)) influences.push_back(by_inset.dot(equations.gradient()));
  }
  return influences;
}

FormationProblem::Equations FormationProblem::SumUp(const State& state,
                                                    bool with_derivatives) const {
  Equations equations;
  for (std::size_t i = 0; i < state.samples.size(); ++i) {
    AddSample(state, with_derivatives, i, &equations);
  }
  const Eigen::Matrix<double, kCount, kCount> by_prior = PriorWeight().asDiagonal();
  equations.Add<kCount>(by_prior, PriorWeight().cwiseProduct(state.parameters - priors_.mean));
  return equations;
}

// A fit that fails counts like one with residuals a little above the noise.
void FormationProblem::AddSample(const State& state, bool with_derivatives, std::size_t i,
                                 Equations* equations) const {
  constexpr double kFailed = 1.5;  // sigmas
  const std::vector<float>& residuals = state.samples[i].residuals;
  const auto count = static_cast<Eigen::Index>(state.samples[i].places.size());
  const Jacobian jacobian = with_derivatives ? JacobianOf(state, MovedBySteps(state, workers_), i)
                                             : Jacobian(Jacobian::Zero(count, kCount));
  for (Eigen::Index j = 0; j < count; ++j) {
    const double weight = RootWeight(state, i, j);
    const double residual =
        residuals.empty() ? kFailed : residuals[static_cast<std::size_t>(j)] / noises_[i];
    equations->Add<1>(weight / noises_[i] * jacobian.row(j),
                      Eigen::Matrix<double, 1, 1>(weight * residual), loss_);
  }
}

FormationVector FormationProblem::PriorWeight() const {
  return std::sqrt(kPixelsAlike) * priors_.sigma.cwiseInverse();
}

}  // namespace velamap
