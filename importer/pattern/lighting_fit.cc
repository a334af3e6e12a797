#include "importer/pattern/lighting_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "importer/detect/gray_levels.h"
#include "importer/geometry/least_squares.h"
#include "importer/lighting/light_map.h"
#include "importer/pattern/pattern_picture.h"
#include "importer/pattern/pattern_pixels.h"

namespace velamap {
namespace {

using P = PatternParameters;

double LeastBlur(const PatternProblem& problem, const P::Vector& parameters) {
  return parameters.segment<2>(P::kBlurU).mean() / problem.model.diagonal_px;
}

void SetLighting(const Lighting& lighting, PatternProblem* problem) {
  PatternModel& model = problem->model;
  if (lighting.IsEven()) {
    model.lighting.release();
    return;
  }
  model.lighting = cv::Mat(problem->patch.values.size(), CV_32F);  // copies of models share the old
  for (int row = 0; row < model.lighting.rows; ++row) {
    for (int column = 0; column < model.lighting.cols; ++column) {
      const Eigen::Vector2d place =
          (Eigen::Vector2d(column, row) - model.center_in_patch_px) / model.diagonal_px;
      model.lighting.at<float>(row, column) = static_cast<float>(std::exp(lighting.LogAt(place)));
    }
  }
}

// Calls take(pixel, jacobian, lane) for all pixels of the fit.
template <typename Take>
inline void ForEachLitPixel(const PatternProblem& problem, const P::Vector& parameters,
                            const Take& take) {
  const ChosenPixels pixels = ChoosePixels(problem, parameters, kMaxPatternPixels);
  const PatternPicture picture(problem.model, parameters);
  const double inverse_diagonal = 1 / problem.model.diagonal_px;
  const auto dark = static_cast<float>(parameters[P::kDark]);
  const auto light = static_cast<float>(parameters[P::kLight]);
  PatternPixels modelled;
  int left = pixels.count;
  for (const ChosenPixels::Group& group : pixels.groups) {
    picture.At(group.x, group.y, &modelled);
    const Floats residual = group.root_weight * (modelled.gray - group.gray);
    const Floats by_log_light = group.root_weight * (dark * modelled.jacobian[P::kDark] +
                                                     light * modelled.jacobian[P::kLight]);
    for (int lane = 0; lane < std::min(kLanes, left); ++lane) {
      take(LitPixel{inverse_diagonal * Eigen::Vector2d(group.x[lane], group.y[lane]),
                    residual[lane], by_log_light[lane]},
           modelled.jacobian, lane, group.root_weight[lane]);
    }
    left -= kLanes;
  }
}

VELAMAP_CLONE_FOR_AVX2 std::vector<LitPixel> LitPixels(const PatternProblem& problem,
                                                       const P::Vector& parameters) {
  std::vector<LitPixel> pixels;
  ForEachLitPixel(problem, parameters,
                  [&](const LitPixel& pixel, const auto&, int, float) { pixels.push_back(pixel); });
  return pixels;
}

// Normal equations of the parameters of the fit, then those of the lighting.
struct JointEquations {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
};

// Prior sigmas of the lighting, as weak as those of the gradient.
Eigen::VectorXd LightingWeight(const Lighting& lighting) {
  constexpr double kBendSigma = 1.0;
  constexpr std::array<double, Lighting::kNumOfBand> kBandSigma = {1.0, 0.3, 1.0, 1.0, 1.0};
  Eigen::VectorXd weight(lighting.parameters().size());
  for (Eigen::Index i = 0; i < weight.size(); ++i) {
    const double sigma =
        i < Lighting::kFirstBand
            ? kBendSigma
            : kBandSigma[static_cast<std::size_t>(i - Lighting::kFirstBand) % kBandSigma.size()];
    weight[i] = kPixelNoise * kPixelNoise / (sigma * sigma);
  }
  return weight;
}

VELAMAP_CLONE_FOR_AVX2 JointEquations SumJointly(const PatternProblem& problem,
                                                 const P::Vector& parameters,
                                                 const Lighting& lighting) {
  const Eigen::Index num_lighting = lighting.parameters().size(), size = P::kCount + num_lighting;
  JointEquations equations{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
  Eigen::VectorXd by_lighting(num_lighting), jacobian(size);
  ForEachLitPixel(problem, parameters,
                  [&](const LitPixel& pixel, const auto& of_fit, int lane, float root_weight) {
                    for (int i = 0; i < P::kCount; ++i) {
                      jacobian[i] = root_weight * of_fit[static_cast<std::size_t>(i)][lane];
                    }
                    lighting.LogAt(pixel.place, &by_lighting);
                    jacobian.tail(num_lighting) = pixel.by_log_light * by_lighting;
                    equations.hessian.selfadjointView<Eigen::Lower>().rankUpdate(jacobian);
                    equations.gradient += pixel.residual * jacobian;
                  });
  Eigen::VectorXd weight(size);
  weight << problem.weight, LightingWeight(lighting);
  equations.hessian.diagonal() += weight;
  equations.gradient.head<P::kCount>() += problem.weight.cwiseProduct(parameters - problem.mean);
  return equations;
}

// Improves the lighting and the fit in turns, by steps of both together. Returns false if the fit
// fails.
bool RefineLighting(Lighting* lighting, PatternProblem* problem, PatternMinimum* minimum) {
  constexpr int kMaxSteps = 10;
  constexpr double kLeastDecrease = 0.005, kMaxDamping = 10;
  // The fit reads the surroundings of the marker again, so it changes even with the same lighting.
  SetLighting(*lighting, problem);
  if (!RefinePatternFit(kMaxPatternPixels, kPatternTolerancePx, problem, minimum)) return false;
  double rms = minimum->equations.Rms(), damping = 1e-3;
  for (int i = 0; i < kMaxSteps; ++i) {
    JointEquations equations = SumJointly(*problem, minimum->parameters, *lighting);
    equations.hessian.diagonal() *= 1 + damping;
    Eigen::VectorXd step = -equations.gradient;
    if (!SolveInPlace(equations.hessian, step)) return false;
    const Lighting before = *lighting;
    const PatternMinimum minimum_before = *minimum;
    const PatternModel model_before = problem->model;
    lighting->Move(step.tail(lighting->parameters().size()),
                   LeastBlur(*problem, minimum->parameters));
    SetLighting(*lighting, problem);
    if (!RefinePatternFit(kMaxPatternPixels, kPatternTolerancePx, problem, minimum)) return false;
    const double next = minimum->equations.Rms();
    if (!(next < rms)) {
      *lighting = before;
      *minimum = minimum_before;
      problem->model = model_before;
      damping = std::max(0.03, 10 * damping);
      if (damping > kMaxDamping) break;
      continue;
    }
    if (next > (1 - kLeastDecrease) * rms) break;
    rms = next;
    damping *= 0.1;
  }
  return true;
}

// Refines a lighting from its start. Takes it and its fit if they leave clearly less.
bool TakeIfBetter(Lighting start, Lighting* lighting, PatternProblem* problem,
                  PatternMinimum* minimum) {
  constexpr double kBetter = 0.95;  // of the RMS
  PatternMinimum next = *minimum;
  const PatternModel model = problem->model;
  if (RefineLighting(&start, problem, &next) &&
      next.equations.Rms() < kBetter * minimum->equations.Rms()) {
    *lighting = start;
    *minimum = std::move(next);
    return true;
  }
  problem->model = model;
  return false;
}

}  // namespace

Lighting FitLighting(PatternProblem* problem, PatternMinimum* minimum) {
  constexpr double kExcess = 2.5, kAmplitude = 0.004;
  // The ink of a bad print differs from cell to cell, which light explains in small part only.
  constexpr double kMaxUnexplained = 0.4;
  // Two bands may share the work, and the search for a band is coarse.
  constexpr double kMaxUnexplainedByBand = 0.65;
  constexpr int kMaxBands = 2;
  LightMap map = MapLight(LitPixels(*problem, minimum->parameters));
  const double excess = map.excess;
  const auto is_uneven = [&] { return map.excess > kExcess && map.amplitude > kAmplitude; };
  if (!is_uneven()) return {};
  const PatternModel even_model = problem->model;
  const PatternMinimum even_minimum = *minimum;
  Lighting lighting;
  while (is_uneven() && lighting.num_bands() < kMaxBands) {
    const FoundBand found = FindBand(map);
    if (found.unexplained > kMaxUnexplainedByBand) break;
    Lighting with_band = lighting;
    with_band.AddBand(found.band);
    const bool takes_band = TakeIfBetter(with_band, &lighting, problem, minimum);
    // Else what falls off along the marker without an edge.
    const bool takes_bend =
        !takes_band && lighting.IsEven() && TakeIfBetter(lighting, &lighting, problem, minimum);
    if (takes_band || takes_bend) map = MapLight(LitPixels(*problem, minimum->parameters));
    if (!takes_band) break;
  }
  if (lighting.IsEven()) return lighting;
  if (map.excess - 1 > kMaxUnexplained * (excess - 1)) {
    problem->model = even_model;
    *minimum = even_minimum;
    return {};
  }
  return lighting;
}

P::Matrix AddedByLighting(const PatternProblem& problem, const PatternMinimum& minimum,
                          const Lighting& lighting) {
  if (lighting.IsEven()) return P::Matrix::Zero();
  const Eigen::MatrixXd hessian = SumJointly(problem, minimum.parameters, lighting).hessian;
  const Eigen::Index size = hessian.rows(), num_lighting = size - P::kCount;
  const auto of_fit = hessian.topLeftCorner<P::kCount, P::kCount>().selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd by_lighting = hessian.bottomLeftCorner(num_lighting, P::kCount);
  const Eigen::MatrixXd moved = P::Matrix(of_fit).llt().solve(by_lighting.transpose());
  const Eigen::MatrixXd of_lighting =
      Eigen::MatrixXd(
          hessian.bottomRightCorner(num_lighting, num_lighting).selfadjointView<Eigen::Lower>()) -
      by_lighting * moved;
  const P::Matrix added = moved * of_lighting.llt().solve(moved.transpose());
  return added.allFinite() ? added : P::Matrix::Zero();
}

}  // namespace velamap
