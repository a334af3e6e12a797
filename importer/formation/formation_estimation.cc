#include "importer/formation/formation_estimation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <spdlog/spdlog.h>

#include "importer/base/statistics.h"
#include "importer/formation/balanced_edges.h"
#include "importer/formation/formation_state.h"
#include "importer/geometry/least_squares.h"

namespace velamap {
namespace {

constexpr int kCount = kNumFormationParameters;
using Vector = FormationVector;
using State = FormationState;

// The means of the priors, and the steps of derivatives by differences.
const Vector kMean = (Vector() << std::log(1.6), 0.0, 0.1, 0.0, 0.0, 0.0).finished();
const Vector kStep = (Vector() << 0.02, 0.004, 0.02, 0.04, 0.0004, 0.02).finished();

// The sigmas of the priors and the limits of the parameters: those of usual cameras, and of what
// printers do to the edge of a dark area.
struct Limits {
  Vector sigma, min, max;
};

Limits LimitsFor(const std::vector<FormationSample>& samples) {
  constexpr double kInkSigma_mm = 0.1, kMaxInkSpread_mm = 0.3;
  std::vector<double> sides_mm;
  for (const FormationSample& sample : samples) sides_mm.push_back(sample.side_mm);
  const double side_mm = Median(std::move(sides_mm));
  const double ink_sigma = kInkSigma_mm / side_mm, max_ink = kMaxInkSpread_mm / side_mm;
  Limits limits;
  limits.sigma << 0.6, 0.05, 0.5, 0.3, ink_sigma, 0.2;
  limits.min << std::log(0.8), -0.05, -0.3, std::log(0.5), -max_ink, -kMaxEdgeShift;
  limits.max << std::log(3.2), 0.13, 2.0, std::log(2.5), max_ink, kMaxEdgeShift;
  return limits;
}

// Blur, demosaicing, filters and compression give neighbouring pixels errors in common: about so
// many of them tell as much as one independent pixel. If all counted, they would overrule the
// priors.
constexpr double kPixelsAlike = 10.0;

// 1 sigma of the width of one quiet zone around the mean width, cells, while the mean is unknown.
constexpr double kQuietZoneSigma = 0.25;

const std::vector<State>& MovedBySteps(const State& state, int num_threads) {
  if (!state.moved) {
    std::vector<State> moved;
    for (int k = 0; k < kCount; ++k) {
      Vector parameters = state.parameters;
      parameters[k] += kStep[k];
      moved.push_back(MovedTo(parameters, state, num_threads));
    }
    state.moved = std::make_shared<const std::vector<State>>(std::move(moved));
  }
  return *state.moved;
}

using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, kCount>;

// The root of the weight of the j-th residual of the i-th sample.
double RootWeight(const State& state, std::size_t i, Eigen::Index j) {
  const SamplePlace& place = state.samples[i].places[static_cast<std::size_t>(j)];
  return place.is_at_outline_corner ? std::sqrt(state.formation->parameters().outline_corner_weight)
                                    : 1.0;
}

double WeightedResidual(const State& state, std::size_t i, Eigen::Index j) {
  return RootWeight(state, i, j) * state.samples[i].residuals[static_cast<std::size_t>(j)];
}

// Derivatives of the weighted residuals of the i-th sample; zero where a fit failed or jumped.
Jacobian JacobianOf(const State& state, const std::vector<State>& moved, std::size_t i) {
  const auto residuals_of = [i](const State& one) {
    const std::vector<float>& residuals = one.samples[i].residuals;
    return Eigen::Map<const Eigen::VectorXf>(residuals.data(),
                                             static_cast<Eigen::Index>(residuals.size()))
        .cast<double>();
  };
  const auto count = static_cast<Eigen::Index>(state.samples[i].places.size());
  Jacobian jacobian = Jacobian::Zero(count, kCount);
  const bool are_alike = std::all_of(moved.begin(), moved.end(), [&](const State& one) {
    return AreAlike(state.samples[i], one.samples[i]);
  });
  for (int k = 0; are_alike && k < kCount; ++k) {
    jacobian.col(k) =
        (residuals_of(moved[static_cast<std::size_t>(k)]) - residuals_of(state)) / kStep[k];
  }
  for (Eigen::Index j = 0; j < count; ++j) jacobian.row(j) *= RootWeight(state, i, j);
  return jacobian;
}

// The estimation as a problem of MinimizeSquares(). A sample whose fit fails counts as residuals
// of 6 sigmas.
class FormationProblem : public LeastSquaresProblem<kCount> {
 public:
  using Parameters = State;

  FormationProblem(const Limits& limits, double noise, int num_threads)
      : limits_(limits), noise_(noise), num_threads_(num_threads), loss_{9 * noise * noise} {}

  // Derivatives take six fits of every sample, so that there are none where the cost is higher
  // than before: such a step is not taken.
  void Evaluate(const State& state, bool, Equations* equations) const {
    *equations = SumUp(state, nullptr);
    if (equations->cost() > least_cost_) return;
    least_cost_ = equations->cost();
    *equations = SumUp(state, &MovedBySteps(state, num_threads_));
  }

  State Plus(const State& state, const Step& step) const {
    return MovedTo((state.parameters + step).cwiseMax(limits_.min).cwiseMin(limits_.max), state,
                   num_threads_);
  }

  double Cost(const State& state) const { return SumUp(state, nullptr).cost(); }

  // The part of FormationEstimate::inset_sigma_px that the parameters cause, at their minimum. The
  // residuals of a sample have errors in common (which no parameter describes), so that the scatter
  // of the samples' gradients tells the covariance (Huber 1967, White 1980), but few samples may
  // agree by chance: it is no smaller than for independent residuals.
  double InsetSigma(const State& state) const {
    const std::vector<State>& moved = MovedBySteps(state, num_threads_);
    Vector inset_by;
    for (int k = 0; k < kCount; ++k) {
      inset_by[k] = MeanInset(state, moved[static_cast<std::size_t>(k)]) / kStep[k];
    }
    const Vector by_inset = SumUp(state, &moved).hessian().ldlt().solve(inset_by);
    const Vector by_prior =
        PriorWeight().cwiseAbs2().cwiseProduct(limits_.sigma).cwiseProduct(by_inset);
    const double independent = noise_ * noise_ * inset_by.dot(by_inset);
    return std::sqrt(std::max(
        VarianceOfSum(InfluencesOf(state, moved, by_inset)) + by_prior.squaredNorm(), independent));
  }

 private:
  // How much each sample moves the mean inset.
  std::vector<double> InfluencesOf(const State& state, const std::vector<State>& moved,
                                   const Vector& by_inset) const {
    std::vector<double> influences;
    for (std::size_t i = 0; i < state.samples.size(); ++i) {
      const Jacobian jacobian = JacobianOf(state, moved, i);
      if (jacobian.isZero(0)) continue;
      Vector gradient = Vector::Zero();
      for (Eigen::Index j = 0; j < jacobian.rows(); ++j) {
        const double residual = WeightedResidual(state, i, j);
        gradient += loss_.Weight(residual * residual) * residual * jacobian.row(j).transpose();
      }
      influences.push_back(by_inset.dot(gradient));
    }
    return influences;
  }

  // Limits the influence of single samples, because one with something in front of it says nothing
  // about the others.
  static double VarianceOfSum(const std::vector<double>& influences) {
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

  // Without derivatives if `moved` is null.
  Equations SumUp(const State& state, const std::vector<State>* moved) const {
    Equations equations;
    for (std::size_t i = 0; i < state.samples.size(); ++i) {
      const auto count = static_cast<Eigen::Index>(state.samples[i].places.size());
      const Jacobian jacobian =
          moved != nullptr ? JacobianOf(state, *moved, i) : Jacobian(Jacobian::Zero(count, kCount));
      for (Eigen::Index j = 0; j < count; ++j) {
        const double residual = state.samples[i].residuals.empty()
                                    ? 6 * noise_ * RootWeight(state, i, j)
                                    : WeightedResidual(state, i, j);
        equations.Add<1>(jacobian.row(j), Eigen::Matrix<double, 1, 1>(residual), loss_);
      }
    }
    const Eigen::Matrix<double, kCount, kCount> by_prior = PriorWeight().asDiagonal();
    equations.Add<kCount>(by_prior, PriorWeight().cwiseProduct(state.parameters - kMean));
    return equations;
  }

  Vector PriorWeight() const {
    return std::sqrt(kPixelsAlike) * noise_ * limits_.sigma.cwiseInverse();
  }

  const Limits& limits_;
  double noise_;
  int num_threads_;
  CauchyLoss loss_;
  mutable double least_cost_ = std::numeric_limits<double>::infinity();
};

// The samples fitted with the gamma that leaves the least noise; none if no fit succeeds.
State BestStart(const std::vector<FormationSample>& samples,
                const ImageFormationParameters& formation, int num_threads) {
  constexpr double kGammas[] = {1.0, 1.5, 2.2};
  State best;
  double least_noise = std::numeric_limits<double>::infinity();
  for (const double gamma : kGammas) {
    Vector start = kMean;
    start[0] = std::log(gamma);
    State state = FitSamples(samples, start, formation, num_threads);
    const double noise = NoiseOf(state);
    if (noise < least_noise) {
      least_noise = noise;
      best = std::move(state);
    }
  }
  return best;
}

// Every fourth sample, but not fewer than kMinSome.
std::vector<FormationSample> SomeOf(const std::vector<FormationSample>& all) {
  constexpr std::size_t kMinSome = 8, kOneOf = 4;
  const std::size_t num = std::max(kMinSome, all.size() / kOneOf);
  const std::size_t step = std::max<std::size_t>(1, all.size() / num);
  std::vector<FormationSample> some;
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

void Minimize(const Limits& limits, int max_iterations, int num_threads, State* state) {
  LeastSquaresOptions options;
  options.max_iterations = max_iterations;
  options.initial_damping = 1e-3;
  options.max_damping = 1e2;
  options.min_relative_decrease = 2e-4;
  *state = WithPooledQuietZone(std::move(*state), num_threads);
  GaussNewtonEquations<kCount> equations;
  MinimizeSquares(options, FormationProblem(limits, NoiseOf(*state), num_threads), state,
                  &equations);
}

// The pixels at the corners of outlines count once straight edges tell how they look.
State Minimized(const std::vector<FormationSample>& samples, const Limits& limits, bool is_inverted,
                bool sharpens_light, int num_threads) {
  constexpr int kMaxIterations = 6;
  ImageFormationParameters formation;
  formation.is_inverted = is_inverted;
  formation.sharpens_light = sharpens_light;
  formation.quiet_zone_sigma_cells = kQuietZoneSigma;
  formation.outline_corner_weight = 0.0;
  State state = BestStart(samples, formation, num_threads);
  if (state.samples.empty()) return state;
  Minimize(limits, kMaxIterations, num_threads, &state);
  state = WithOutlineCorners(OutlineCornerWeight(state), state, num_threads);
  Minimize(limits, kMaxIterations, num_threads, &state);
  return state;
}

// Whether the camera sharpens light rather than grey values. Most sharpen grey values, and under
// noise and compression both explain the samples. Gives all pixels the same weights in both states,
// so that their costs can be compared.
bool LightWins(const Limits& limits, int num_threads, State* by_gray, State* by_light) {
  constexpr double kClearlyLess = 0.9;
  const double weight = std::min(OutlineCornerWeight(*by_gray), OutlineCornerWeight(*by_light));
  *by_gray = WithOutlineCorners(weight, *by_gray, num_threads);
  *by_light = WithOutlineCorners(weight, *by_light, num_threads);
  const double noise = std::min(NoiseOf(*by_gray), NoiseOf(*by_light));
  const FormationProblem problem(limits, noise, num_threads);
  const double cost_by_gray = problem.Cost(*by_gray), cost_by_light = problem.Cost(*by_light);
  spdlog::debug("cost of sharpened grey values {:.4g}, of sharpened light {:.4g}", cost_by_gray,
                cost_by_light);
  return cost_by_light < kClearlyLess * cost_by_gray;
}

// Cameras denoise, sharpen and compress in ways that no parameter describes, and lenses do not blur
// like a Gaussian. Over 23 clips of another renderer with drawn lenses, tone curves, noise and
// compression, the insets were wrong by 2.2 % of the blur (RMS).
double InsetSigmaByModel(const State& state) {
  constexpr double kOfBlur = 0.02;
  std::vector<double> blurs_px;
  for (const FittedSample& sample : state.samples) {
    blurs_px.push_back(sample.minimum.parameters.segment<2>(PatternParameters::kBlurU).mean());
  }
  return kOfBlur * Median(std::move(blurs_px));
}

}  // namespace

FormationEstimate EstimateFormation(const std::vector<FormationSample>& samples, bool is_inverted,
                                    int num_threads) {
  constexpr double kMinQuietZoneSigma = 0.1;  // cells; scissors
  constexpr int kFewIterations = 2;
  if (samples.empty()) return {};
  // Some samples tell which description of the camera is right, and nearly its parameters; then all
  // take few steps.
  const Limits limits = LimitsFor(samples);
  const std::vector<FormationSample> some = SomeOf(samples);
  State by_gray = Minimized(some, limits, is_inverted, false, num_threads);
  State by_light = Minimized(some, limits, is_inverted, true, num_threads);
  KeepOnly(by_light.sample_idxs, &by_gray);
  KeepOnly(by_gray.sample_idxs, &by_light);
  if (by_gray.samples.empty()) return {};
  const bool light_wins = LightWins(limits, num_threads, &by_gray, &by_light);
  const State& likely = light_wins ? by_light : by_gray;
  State winner =
      FitSamples(samples, likely.parameters, likely.formation->parameters(), num_threads);
  if (winner.samples.empty()) return {};
  Minimize(limits, kFewIterations, num_threads, &winner);
  const BalancedEdges balanced = WithBalancedEdges(winner, num_threads);
  const State& best = balanced.state;
  FormationEstimate estimate;
  estimate.parameters = best.formation->parameters();
  estimate.parameters.quiet_zone_sigma_cells =
      std::clamp(RobustSigma(QuietZones(best)), kMinQuietZoneSigma, kQuietZoneSigma);
  estimate.num_samples = static_cast<int>(best.samples.size());
  estimate.noise_gray = NoiseOf(best);
  // No camera is exactly as either of the two descriptions says, and they may differ by more than
  // the noise explains.
  const double by_model_px =
      std::hypot(0.5 * MeanInset(by_gray, by_light), InsetSigmaByModel(winner));
  const FormationProblem problem(limits, estimate.noise_gray, num_threads);
  estimate.inset_sigma_px =
      std::hypot(problem.InsetSigma(winner), by_model_px, balanced.inset_sigma_px);
  return estimate;
}

}  // namespace velamap
