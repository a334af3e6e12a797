#include "importer/formation/formation_estimation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "importer/base/parallel.h"
#include "importer/base/statistics.h"
#include "importer/geometry/least_squares.h"
#include "importer/refine/pattern_picture.h"
#include "importer/refine/pattern_problem.h"

namespace velamap {
namespace {

using P = PatternParameters;

constexpr int kCount = 5;  // log gamma, S, sharpening, log radius, ink spread
using Vector = Eigen::Matrix<double, kCount, 1>;

// Priors and limits: usual cameras. The steps are for derivatives.
const Vector kMean = (Vector() << std::log(1.6), 0.0, 0.1, 0.0, 0.0).finished();
const Vector kSigma = (Vector() << 0.6, 0.05, 0.5, 0.3, 0.004).finished();
const Vector kMin = (Vector() << std::log(0.8), -0.05, -0.3, std::log(0.5), -0.02).finished();
const Vector kMax = (Vector() << std::log(3.2), 0.13, 2.0, std::log(2.5), 0.02).finished();
const Vector kStep = (Vector() << 0.02, 0.004, 0.02, 0.04, 0.0004).finished();

ImageFormationParameters ParametersOf(const Vector& p, bool is_inverted) {
  return {std::exp(p[0]), p[1], p[2], std::exp(p[3]), p[4], is_inverted};
}

// A sample with its fit.
struct FittedSample {
  cv::Mat gray;
  cv::Rect patch_box;
  PatternProblem problem;
  PatternMinimum minimum;
  std::vector<cv::Point> places;  // of all pixels that count, in the problem's box
  std::vector<float> residuals;   // at these places; empty: the fit failed
};

std::optional<FittedSample> FitSample(const FormationSample& sample,
                                      const ImageFormation& formation) {
  FittedSample fitted;
  fitted.gray = sample.gray;
  auto problem =
      MakePatternProblem(sample.gray, sample.corners_px, sample.cells, formation, &fitted.minimum);
  if (!problem || !FitPatternInPasses(&*problem, &fitted.minimum)) return std::nullopt;
  fitted.problem = std::move(*problem);
  fitted.patch_box = cv::Rect(fitted.problem.patch.origin_px, fitted.problem.patch.values.size());
  const PatternPicture picture(fitted.problem.model, fitted.minimum.parameters);
  const Eigen::Vector2d& center = fitted.problem.model.center_px;
  for (int y = 0; y < fitted.problem.box.height; ++y) {
    for (int x = 0; x < fitted.problem.box.width; ++x) {
      if (picture.Covers(AllLanes(fitted.problem.box.x + x - center.x()),
                         AllLanes(fitted.problem.box.y + y - center.y()))[0]) {
        fitted.places.emplace_back(x, y);
      }
    }
  }
  return fitted;
}

// Modelled less recorded grey values. The patch is without the sharpening, which is applied to the
// difference again: it would otherwise depend on the sharpening how large the noise looks.
std::vector<float> ResidualsOf(const FittedSample& sample, const ImageFormation& formation) {
  const PatternProblem& problem = sample.problem;
  const PatternPicture picture(problem.model, sample.minimum.parameters);
  const cv::Point patch_from_box = problem.box.tl() - problem.patch.origin_px;
  const Eigen::Vector2d box_from_center =
      Eigen::Vector2d(problem.box.x, problem.box.y) - problem.model.center_px;
  cv::Mat difference = cv::Mat::zeros(problem.box.size(), CV_32F);
  PatternPixels modelled;
  for (std::size_t begin = 0; begin < sample.places.size(); begin += kLanes) {
    const std::size_t end = std::min(begin + kLanes, sample.places.size());
    Floats x{}, y{};
    for (std::size_t i = begin; i < end; ++i) {
      x[i - begin] = static_cast<float>(sample.places[i].x + box_from_center.x());
      y[i - begin] = static_cast<float>(sample.places[i].y + box_from_center.y());
    }
    picture.At(x, y, &modelled);
    for (std::size_t i = begin; i < end; ++i) {
      difference.at<float>(sample.places[i]) =
          modelled.gray[i - begin] -
          problem.patch.values.at<float>(sample.places[i] + patch_from_box);
    }
  }
  const ImageFormationParameters& parameters = formation.parameters();
  if (parameters.sharpening != 0) {
    cv::Mat blurred;
    cv::GaussianBlur(difference, blurred, {0, 0}, parameters.sharpening_radius_px,
                     parameters.sharpening_radius_px, cv::BORDER_CONSTANT);
    difference = (1 + parameters.sharpening) * difference - parameters.sharpening * blurred;
  }
  std::vector<float> residuals;
  residuals.reserve(sample.places.size());
  for (const cv::Point& place : sample.places) residuals.push_back(difference.at<float>(place));
  return residuals;
}

// From the fit with another image formation. `before` is that one's tone curve.
void Refit(const ImageFormation& formation, const ToneCurve& before, FittedSample* sample) {
  // All pixels of most samples and a small tolerance, so that differences give derivatives.
  constexpr int kMaxPixels = 4000;
  constexpr double kTolerancePx = 0.003;
  PatternProblem& problem = sample->problem;
  problem.patch = CutPatch(sample->gray, sample->patch_box, formation);
  problem.model.tone = &formation.tone();
  problem.model.ink_spread_cells =
      formation.parameters().ink_spread_sides * problem.model.num_cells;
  for (const int index : {P::kDark, P::kLight}) {
    double& light = sample->minimum.parameters[index];
    light = formation.tone().Decode(before.Encode(light));
  }
  sample->residuals = RefinePatternFit(kMaxPixels, kTolerancePx, &problem, &sample->minimum)
                          ? ResidualsOf(*sample, formation)
                          : std::vector<float>();
}

// The parameters that all samples share, and the samples fitted with them.
struct State {
  Vector parameters;
  std::shared_ptr<const ImageFormation> formation;
  std::vector<FittedSample> samples;
};

State MovedTo(const Vector& parameters, const State& state, int num_threads) {
  State moved{parameters,
              std::make_shared<const ImageFormation>(
                  ParametersOf(parameters, state.formation->parameters().is_inverted)),
              state.samples};
  ParallelFor(moved.samples.size(), num_threads, [&](std::size_t i) {
    Refit(*moved.formation, state.formation->tone(), &moved.samples[i]);
  });
  return moved;
}

double NoiseOf(const State& state) {
  std::vector<double> values;
  for (const FittedSample& sample : state.samples) {
    values.insert(values.end(), sample.residuals.begin(), sample.residuals.end());
  }
  constexpr double kMinNoise = 0.5;  // 8 bits round
  return values.empty() ? std::numeric_limits<double>::infinity()
                        : std::max(kMinNoise, RobustSigma(values));
}

// The estimation as a problem of MinimizeSquares(). A sample whose fit fails counts as residuals
// of 6 sigmas.
class FormationProblem : public LeastSquaresProblem<kCount> {
 public:
  using Parameters = State;

  FormationProblem(double noise, int num_threads)
      : noise_(noise), num_threads_(num_threads), loss_{9 * noise * noise} {}

  void Evaluate(const State& state, bool, Equations* equations) const {
    *equations = Equations();
    std::vector<State> moved;
    for (int k = 0; k < kCount; ++k) {
      Vector parameters = state.parameters;
      parameters[k] += kStep[k];
      moved.push_back(MovedTo(parameters, state, num_threads_));
    }
    for (std::size_t i = 0; i < state.samples.size(); ++i) {
      const std::vector<float>& residuals = state.samples[i].residuals;
      const std::size_t count = state.samples[i].places.size();
      const bool has_derivatives = std::all_of(moved.begin(), moved.end(), [&](const State& one) {
        return one.samples[i].residuals.size() == count && residuals.size() == count;
      });
      for (std::size_t j = 0; j < count; ++j) {
        const double residual = residuals.empty() ? 6 * noise_ : residuals[j];
        Eigen::Matrix<double, 1, kCount> jacobian = Eigen::Matrix<double, 1, kCount>::Zero();
        for (int k = 0; has_derivatives && k < kCount; ++k) {
          jacobian[k] =
              (moved[static_cast<std::size_t>(k)].samples[i].residuals[j] - residual) / kStep[k];
        }
        equations->Add<1>(jacobian, Eigen::Matrix<double, 1, 1>(residual), loss_);
      }
    }
    const Vector weight = noise_ * kSigma.cwiseInverse();
    const Eigen::Matrix<double, kCount, kCount> by_prior = weight.asDiagonal();
    equations->Add<kCount>(by_prior, weight.cwiseProduct(state.parameters - kMean));
  }

  State Plus(const State& state, const Step& step) const {
    return MovedTo((state.parameters + step).cwiseMax(kMin).cwiseMin(kMax), state, num_threads_);
  }

 private:
  double noise_;
  int num_threads_;
  CauchyLoss loss_;
};

State FitAll(const std::vector<FormationSample>& samples, double gamma, bool is_inverted,
             int num_threads) {
  State state;
  state.parameters = kMean;
  state.parameters[0] = std::log(gamma);
  state.formation =
      std::make_shared<const ImageFormation>(ParametersOf(state.parameters, is_inverted));
  std::vector<std::optional<FittedSample>> fitted(samples.size());
  ParallelFor(samples.size(), num_threads, [&](std::size_t i) {
    fitted[i] = FitSample(samples[i], *state.formation);
    if (fitted[i]) Refit(*state.formation, state.formation->tone(), &*fitted[i]);
  });
  for (std::optional<FittedSample>& sample : fitted) {
    if (sample) state.samples.push_back(std::move(*sample));
  }
  return state;
}

}  // namespace

FormationEstimate EstimateFormation(const std::vector<FormationSample>& samples, bool is_inverted,
                                    int num_threads) {
  constexpr double kGammas[] = {1.0, 1.5, 2.2};
  constexpr int kNumRounds = 2;  // each with the noise of the one before
  State best;
  double least_noise = std::numeric_limits<double>::infinity();
  for (const double gamma : kGammas) {
    State state = FitAll(samples, gamma, is_inverted, num_threads);
    const double noise = NoiseOf(state);
    if (noise < least_noise) {
      least_noise = noise;
      best = std::move(state);
    }
  }
  if (!std::isfinite(least_noise)) return {};
  LeastSquaresOptions options;
  options.max_iterations = 6;
  options.initial_damping = 1e-3;
  options.max_damping = 1e2;
  options.min_relative_decrease = 2e-4;
  for (int round = 0; round < kNumRounds; ++round) {
    GaussNewtonEquations<kCount> equations;
    MinimizeSquares(options, FormationProblem(NoiseOf(best), num_threads), &best, &equations);
  }
  return {best.formation->parameters(), static_cast<int>(best.samples.size()), NoiseOf(best)};
}

}  // namespace velamap
