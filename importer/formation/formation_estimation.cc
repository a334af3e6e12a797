#include "importer/formation/formation_estimation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "importer/base/log.h"
#include "importer/base/parallel.h"
#include "importer/base/statistics.h"
#include "importer/formation/balanced_edges.h"
#include "importer/formation/formation_problem.h"
#include "importer/formation/sample_bend.h"
#include "importer/pattern/clipped_pixels.h"
#include "importer/pattern/lighting_fit.h"

namespace velamap {
namespace {

using State = FormationState;

// 1 sigma of the width of one quiet zone around the mean width, cells, while the mean is unknown.
constexpr double kQuietZoneSigma = 0.25;

// Fits the samples with a usual camera but several values of gamma and sharpening, and returns the
// fit with the least noise; without samples if no fit succeeds. If white is clipped, a start
// with little sharpening does not reach the minimum of a camera that sharpens strongly.
State BestStart(const std::vector<FormationSample>& samples, const FormationPriors& priors,
                const ImageFormationParameters& formation, const FitWorkers& workers) {
  constexpr double kGammas[] = {1.0, 1.5, 2.2}, kSharpenings[] = {0.1, 0.8};
  State best;
  double least_noise = std::numeric_limits<double>::infinity();
  for (const double gamma : kGammas) {
    for (const double sharpening : kSharpenings) {
      FormationVector start = priors.mean;
      start[kLogGamma] = std::log(gamma);
      start[kSharpening] = sharpening;
      State state = FitSamples(samples, start, priors.side_mm, formation, workers);
      const double noise = NoiseOf(state);
      if (noise < least_noise) {
        least_noise = noise;
        best = std::move(state);
      }
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

void Minimize(const FormationPriors& priors, int max_iterations, const FitWorkers& workers,
              State* state) {
  LeastSquaresOptions options;
  options.max_iterations = max_iterations;
  options.initial_damping = 1e-3;
  options.max_damping = 1e2;
  options.min_relative_decrease = 2e-4;
  *state = WithPooledQuietZone(std::move(*state), workers);
  FormationProblem::Equations equations;
  MinimizeSquares(options, FormationProblem(priors, NoisesOf(*state), workers), state, &equations);
}

// Minimizes without the pixels at the corners of outlines first, and then with the weight that
// follows from their residuals.
State Minimized(const std::vector<FormationSample>& samples, const FormationPriors& priors,
                bool is_inverted, const FitWorkers& workers) {
  constexpr int kMaxIterations = 6;
  ImageFormationParameters formation;
  formation.is_inverted = is_inverted;
  formation.quiet_zone_sigma_cells = kQuietZoneSigma;
  formation.outline_corner_weight = 0.0;
  State state = BestStart(samples, priors, formation, workers);
  if (state.samples.empty()) return state;
  Minimize(priors, kMaxIterations, workers, &state);
  state = WithOutlineCorners(OutlineCornerWeight(state), state, workers);
  Minimize(priors, kMaxIterations, workers, &state);
  return state;
}

// Cameras denoise, sharpen and compress in ways that no parameter describes, and lenses do not blur
// like a Gaussian. How far edges are moved beyond what the parameters explain, and how far inner
// edges lie from where the best parameters leave them, shows how far a camera is from the model.
// The factors are calibrated on pictures with known insets: 0.5 % of the blur and half of the
// latter shift match the errors for 64 cameras drawn by another renderer; a twentieth of the former
// shift matches the errors after median and bilateral filters.
double InsetSigmaByModel(const State& winner, const State& balanced) {
  constexpr double kOfBlur = 0.005, kOfInnerShift = 0.5, kOfEdgeShift = 0.05;
  std::vector<double> blurs_px;
  for (const FittedSample& sample : winner.samples) {
    blurs_px.push_back(sample.minimum.parameters.segment<2>(PatternParameters::kBlurU).mean());
  }
  const double edge_shift_blurs = balanced.parameters[kEdgeShift];
  const double inner_shift_blurs = edge_shift_blurs - winner.parameters[kEdgeShift];
  return Eigen::Vector3d(kOfBlur, kOfInnerShift * inner_shift_blurs,
                         kOfEdgeShift * edge_shift_blurs)
             .norm() *
         Median(std::move(blurs_px));
}

// A sample that a shadow crosses shows another tone curve than the others.
bool IsLitUnevenly(const FormationSample& sample, const ImageFormation& formation) {
  auto fitted = FitSample(sample, formation);
  if (!fitted) return false;
  PatternProblem& problem = fitted->problem;
  PatternMinimum& minimum = fitted->minimum;
  if (HasClippedPixels(sample.gray, problem.box) &&
      !RefineBeyondClipping(sample.gray, formation, kMaxPatternPixels, kPatternTolerancePx,
                            &problem, &minimum)) {
    return false;
  }
  return !FitLighting(&problem, &minimum).IsEven();
}

// The samples without those that shadows cross, if these are more than a few; else all of them.
std::vector<FormationSample> WithEvenLight(const std::vector<FormationSample>& samples,
                                           const ImageFormationParameters& parameters,
                                           const FitWorkers& workers) {
  constexpr double kFew = 0.1, kMinShare = 0.25;
  constexpr std::size_t kMinSamples = 8;
  const ImageFormation formation(parameters);
  const auto without_uneven = [&](const std::vector<FormationSample>& all) {
    std::vector<char> is_uneven(all.size());
    ParallelFor(all.size(), workers.num_threads,
                [&](std::size_t i) { is_uneven[i] = IsLitUnevenly(all[i], formation); });
    std::vector<FormationSample> even;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!is_uneven[i]) even.push_back(all[i]);
    }
    return even;
  };
  const auto share = [](const std::vector<FormationSample>& part,
                        const std::vector<FormationSample>& all) {
    return static_cast<double>(part.size()) / static_cast<double>(all.size());
  };
  const std::vector<FormationSample> some = SomeOf(samples);
  if (share(without_uneven(some), some) > 1 - kFew) return samples;
  std::vector<FormationSample> even = without_uneven(samples);
  LogDebug("uneven light on {} of {} samples", samples.size() - even.size(), samples.size());
  return share(even, samples) > kMinShare && even.size() >= kMinSamples ? even : samples;
}

FormationEstimate Unknown() {
  FormationEstimate unknown;
  // How far the sRGB curve of most cameras moves edges of the usual sharpness.
  unknown.inset_sigma_px = 0.2;
  return unknown;
}

FormationEstimate EstimateOnce(const std::vector<FormationSample>& samples, bool is_inverted,
                               const FitWorkers& workers) {
  constexpr double kMinQuietZoneSigma = 0.1;  // cells; markers are cut with scissors
  constexpr int kFewIterations = 2;
  if (samples.size() < kMinFormationSamples) return Unknown();
  // Some of the samples nearly give the parameters; then all take few steps.
  const FormationPriors priors = PriorsFor(samples);
  State likely;
  for (const std::vector<FormationSample>& some : {SomeOf(samples), samples}) {
    likely = Minimized(some, priors, is_inverted, workers);
    if (!likely.samples.empty()) break;
  }
  if (likely.samples.empty()) return Unknown();
  FormationVector start = priors.mean;
  start[kLogGamma] = likely.parameters[kLogGamma];
  State winner =
      FitSamples(samples, start, priors.side_mm, likely.formation->parameters(), workers);
  if (winner.samples.size() < kMinFormationSamples) return Unknown();
  winner = FittedWith(likely.formation->parameters(), likely.parameters, winner, workers);
  Minimize(priors, kFewIterations, workers, &winner);
  const BalancedEdges balanced = WithBalancedEdges(winner, workers);
  const BalancedEdges outlines = WithBalancedOutlines(balanced.state, workers);
  const State& best = outlines.state;
  const double noise_gray = NoiseOf(best);
  if (!std::isfinite(noise_gray)) return Unknown();  // no sample could be fitted again
  FormationEstimate estimate;
  estimate.parameters = best.formation->parameters();
  estimate.parameters.quiet_zone_sigma_cells =
      std::clamp(RobustSigma(QuietZones(best)), kMinQuietZoneSigma, kQuietZoneSigma);
  estimate.num_samples = static_cast<int>(best.samples.size());
  estimate.noise_gray = noise_gray;
  const double by_model_px = InsetSigmaByModel(winner, balanced.state);
  const FormationProblem problem(priors, NoisesOf(winner), workers);
  const double by_parameters_px = problem.InsetSigma(winner);
  LogDebug(
      "1 sigma of the inset by parameters {:.4f} px, the model {:.4f} px, inner edges {:.4f} px, "
      "outlines {:.4f} px",
      by_parameters_px, by_model_px, balanced.inset_sigma_px, outlines.inset_sigma_px);
  estimate.inset_sigma_px = Eigen::Vector4d(by_parameters_px, by_model_px, balanced.inset_sigma_px,
                                            outlines.inset_sigma_px)
                                .norm();
  return estimate;
}

}  // namespace

FormationEstimate EstimateFormation(std::vector<FormationSample> samples, bool is_inverted,
                                    const FitWorkers& workers) {
  ImageFormationParameters linear;
  linear.is_inverted = is_inverted;
  if (ShowBend(SomeOf(samples), ImageFormation(linear), workers)) {
    LogDebug("the markers bend, which the estimate of camera and print follows");
    for (FormationSample& sample : samples) sample.may_bend = true;
  }
  FormationEstimate estimate = EstimateOnce(samples, is_inverted, workers);
  if (estimate.num_samples == 0) return estimate;
  const std::vector<FormationSample> even = WithEvenLight(samples, estimate.parameters, workers);
  return even.size() < samples.size() ? EstimateOnce(even, is_inverted, workers) : estimate;
}

}  // namespace velamap
