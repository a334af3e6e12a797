#include "importer/formation/sample_bend.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "importer/base/parallel.h"
#include "importer/detect/gray_levels.h"
#include "importer/geometry/unit_square_map.h"
#include "importer/pattern/pattern_picture.h"

namespace velamap {
namespace {

using P = PatternParameters;

// Parameters of the step: corners, the two bends of the pattern's parameters, and the other terms
// of PatternBend, x and y of each.
constexpr int kNumCornerCoordinates = 2 * static_cast<int>(kNumCorners), kNumPlainBends = 4;
constexpr int kFirstCubic = kNumCornerCoordinates + kNumPlainBends;
constexpr std::array<int, 4> kCubicTerms = {1, 2, 4, 5};
constexpr int kNumSteps = kFirstCubic + 2 * static_cast<int>(kCubicTerms.size());
using StepVector = Eigen::Matrix<double, kNumSteps, 1>;

struct StepEquations {
  Eigen::Matrix<double, kNumSteps, kNumSteps> hessian =
      Eigen::Matrix<double, kNumSteps, kNumSteps>::Zero();
  StepVector gradient = StepVector::Zero();
};

// Derivatives of one pixel of a group.
StepVector RowOf(const PatternPixels& pixels, int lane, const Eigen::Vector2d& uv) {
  StepVector row;
  Eigen::Vector2d slope(0, 0);
  for (int i = 0; i < kNumCornerCoordinates; ++i) {
    row[i] = pixels.jacobian[static_cast<std::size_t>(P::kCorners + i)][lane];
    slope[i % 2] += row[i];
  }
  for (int i = 0; i < kNumPlainBends; ++i) {
    row[kNumCornerCoordinates + i] = pixels.jacobian[static_cast<std::size_t>(P::kBendU + i)][lane];
  }
  const PatternBend::Terms terms = PatternBend::TermsAt(uv.x(), uv.y());
  for (std::size_t i = 0; i < kCubicTerms.size(); ++i) {
    row.segment<2>(kFirstCubic + 2 * static_cast<int>(i)) = slope * terms[kCubicTerms[i]];
  }
  return row;
}

VELAMAP_CLONE_FOR_AVX2 StepEquations EquationsOf(const FittedSample& sample, int max_pixels) {
  const PatternProblem& problem = sample.problem;
  const PatternPicture picture(problem.model, sample.minimum.parameters);
  const UnitSquareMap map(CornersOf(sample.minimum.parameters));
  const Eigen::Vector2d box_px(problem.box.x, problem.box.y);
  StepEquations equations;
  PatternPixels modelled;
  const std::size_t num_groups = (sample.places.size() + kLanes - 1) / kLanes;
  const std::size_t stride = std::max<std::size_t>(1, num_groups * kLanes / max_pixels);
  for (std::size_t g = 0; g < num_groups; g += stride) {
    const PlaceGroup group = PlaceGroupAt(sample, g * kLanes);
    picture.At(group.from_center_x_px, group.from_center_y_px, &modelled);
    for (std::size_t i = group.begin; i < group.end; ++i) {
      const SamplePlace& place = sample.places[i];
      if (IsClipped(sample, place)) continue;
      const Eigen::Vector2d x_px = box_px + Eigen::Vector2d(place.in_box.x, place.in_box.y);
      const auto lane = static_cast<int>(i - group.begin);
      const StepVector row = RowOf(modelled, lane, map.ToSquare(x_px));
      const double weight = place.is_at_outline_corner ? problem.model.outline_corner_weight : 1.0;
      const double residual = modelled.gray[lane] - RecordedGray(sample, place);
      equations.hessian.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
      equations.gradient += weight * residual * row;
    }
  }
  return equations;
}

// One step of Gauss and Newton.
bool StepTowardsBend(int max_pixels, FittedSample* sample) {
  constexpr double kCubicSigma = 0.01;  // of a side
  P::Vector& parameters = sample->minimum.parameters;
  PatternBend::Coefficients& bend_px = sample->problem.model.lens_bend.coefficients_px;
  StepEquations equations = EquationsOf(*sample, max_pixels);
  const double side_px = QuadMeanSide(CornersOf(parameters));
  const double cubic_weight = std::pow(kPixelNoise / (kCubicSigma * side_px), 2);
  StepVector weight, departure;
  weight << sample->problem.weight.segment<kNumCornerCoordinates>(P::kCorners),
      sample->problem.weight.segment<kNumPlainBends>(P::kBendU),
      Eigen::VectorXd::Constant(kNumSteps - kFirstCubic, cubic_weight);
  const P::Vector from_mean = parameters - sample->problem.mean;
  departure.head<kFirstCubic>() << from_mean.segment<kNumCornerCoordinates>(P::kCorners),
      from_mean.segment<kNumPlainBends>(P::kBendU);
  for (std::size_t i = 0; i < kCubicTerms.size(); ++i) {
    departure.segment<2>(kFirstCubic + 2 * static_cast<int>(i)) =
        bend_px.col(kCubicTerms[i]) - sample->lens_bend.coefficients_px.col(kCubicTerms[i]);
  }
  equations.hessian.diagonal() += weight;
  equations.gradient += weight.cwiseProduct(departure);
  const Eigen::LLT<decltype(equations.hessian), Eigen::Lower> factors(equations.hessian);
  if (factors.info() != Eigen::Success) return false;
  const StepVector step = -factors.solve(equations.gradient);
  if (!step.allFinite()) return false;
  parameters.segment<kNumCornerCoordinates>(P::kCorners) += step.head<kNumCornerCoordinates>();
  parameters.segment<kNumPlainBends>(P::kBendU) +=
      step.segment<kNumPlainBends>(kNumCornerCoordinates);
  for (std::size_t i = 0; i < kCubicTerms.size(); ++i) {
    bend_px.col(kCubicTerms[i]) += step.segment<2>(kFirstCubic + 2 * static_cast<int>(i));
  }
  return true;
}

}  // namespace

bool ShowBend(const std::vector<FormationSample>& samples, const ImageFormation& formation,
              const FitWorkers& workers) {
  constexpr double kMinOfSide = 0.02, kMin_px = 0.25, kMinShare = 0.25;
  std::vector<char> is_bent(samples.size());
  ParallelFor(samples.size(), workers.num_threads, [&](std::size_t i) {
    const auto fitted = FitSample(samples[i], formation);
    if (!fitted) return;
    const P::Vector& parameters = fitted->minimum.parameters;
    const double bend_px = parameters.segment<kNumPlainBends>(P::kBendU).norm();
    is_bent[i] = bend_px > std::max(kMin_px, kMinOfSide * QuadMeanSide(CornersOf(parameters)));
  });
  const auto num_bent = std::count(is_bent.begin(), is_bent.end(), 1);
  return static_cast<double>(num_bent) > kMinShare * static_cast<double>(samples.size());
}

bool FollowBend(int max_pixels, double tolerance_px, FittedSample* sample) {
  return StepTowardsBend(max_pixels, sample) &&
         RefinePatternFit(max_pixels, tolerance_px, &sample->problem, &sample->minimum);
}

}  // namespace velamap
