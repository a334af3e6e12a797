#include "reconstruct/adjust/calibration_choice.h"

#include <string>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "reconstruct/adjust/corner_calibration.h"
#include "reconstruct/problem/marker_uncertainty.h"

namespace velamap {
namespace {

// The improvement from freeing some intrinsics.
struct IntrinsicsVerdict {
  double improvement = 0.0;   // of the sum of squares
  double criterion = 0.0;     // the improvement that is significant for the number of parameters
  double needed = 0.0;        // the same with errors that corners have in common
  FreeIntrinsics determined;  // by the images, clearly better than by the calibration

  bool IsSignificant() const { return improvement > needed; }
};

int NumFree(const MarkerSolution& solution, const FreeIntrinsics& free, double sigma) {
  int num_free = 0;
  for (const auto& [camera_id, camera] : solution.calibration) {
    num_free += static_cast<int>(MakeIntrinsicsPrior(camera, free, sigma).free.size());
  }
  return num_free;
}

// `trial` holds the calibration; its options have the sigma of an ordinary one, and `sigma` is the
// sigma of the prior for the trial.
IntrinsicsVerdict JudgeIntrinsics(MarkerSolution trial, const FreeIntrinsics& free, double sigma) {
  const double calibration_sigma = trial.options.intrinsics_sigma;
  SetFreeIntrinsics(free, sigma, &trial);
  const double before = SumOfSquares(trial);
  Minimize(1e-4, &trial);
  IntrinsicsVerdict verdict;
  verdict.improvement = before - SumOfSquares(trial);
  verdict.criterion = verdict.needed = InformationCriterion(NumFree(trial, free, sigma), trial);
  LogDebug("free intrinsics: the sum of squares falls by {:.1f}, {:.1f} needed",
           verdict.improvement, verdict.needed);
  if (!verdict.IsSignificant()) return verdict;
  if (!(FreeIntrinsicsOf(trial.options) == free)) return verdict;  // the distortion folds over
  // The sigmas of the corners still contain the errors of the calibration.
  CalibrateRobustly(&trial);
  Minimize(1e-4, &trial);
  const auto linearization = Linearize(trial);
  // Errors that corners have in common explain a part of the improvement.
  const double factor = ShapeCorrelationFactor(trial, *linearization);
  verdict.needed *= factor * factor;
  verdict.determined = free;
  for (const auto& [camera_id, camera] : trial.calibration) {
    const auto intrinsics = linearization->state.intrinsics.find(camera_id);
    if (intrinsics == linearization->state.intrinsics.end()) continue;  // its images were left out
    const Eigen::MatrixXd covariance =
        factor * factor *
        GlobalCovariance(linearization->problem, linearization->covariance,
                         intrinsics->second.data());
    verdict.determined = DeterminedIntrinsics(verdict.determined,
                                              MakeIntrinsicsPrior(camera, free, calibration_sigma),
                                              trial.model.cameras.at(camera_id), covariance);
  }
  const FreeIntrinsics& found = verdict.determined;
  LogDebug(
      "{:.1f} needed with correlated errors; determined: focal length {}, principal point {}, "
      "distortion {}",
      verdict.needed, found.focal_length, found.principal_point, found.distortion);
  return verdict;
}

// The intrinsics that the images determine and that explain the corners significantly better.
FreeIntrinsics SignificantIntrinsics(const MarkerSolution& solution, double sigma) {
  const FreeIntrinsics all{true, true, true};
  const IntrinsicsVerdict first = JudgeIntrinsics(solution, all, sigma);
  IntrinsicsVerdict verdict = first;
  FreeIntrinsics free = all;
  while (verdict.IsSignificant() && !(verdict.determined == free)) {
    free = verdict.determined;
    if (!free.Any()) return {};
    verdict = JudgeIntrinsics(solution, free, sigma);
    // If a parameter is needed but not determined, wrong values of other parameters would
    // compensate for it.
    const double needed_by_others = first.needed * (1.0 - verdict.criterion / first.criterion);
    if (first.improvement - verdict.improvement > needed_by_others) return {};
  }
  return verdict.IsSignificant() ? free : FreeIntrinsics{};
}

}  // namespace

std::optional<RefinedIntrinsics> ChooseIntrinsics(const MarkerSolution& solution) {
  // The sigma of a calibration that the images contradict, as a multiple of its usual one.
  constexpr double kContradicted = 3.0;
  const MarkerAdjustmentOptions& options = solution.options;
  if (!options.refine_calibration || FreeIntrinsicsOf(options).Any()) return std::nullopt;
  const double sigma = kContradicted * options.intrinsics_sigma;
  try {
    const FreeIntrinsics free = SignificantIntrinsics(solution, sigma);
    if (free.Any()) return RefinedIntrinsics{free, sigma};
  } catch (const DataError& error) {
    LogDebug("the calibration cannot be tested: {}", error.what());
  }
  return std::nullopt;
}

void ReportRefinement(const FreeIntrinsics& free, double calibration_sigma,
                      MarkerSolution* solution) {
  for (const auto& [camera_id, camera] : solution->model.cameras) {
    const Camera& calibration = solution->calibration.at(camera_id);
    const std::string text =
        fmt::format("the images contradict the calibration, which is refined: {}",
                    DescribeRefinement(calibration, camera));
    if (IsWithin(MakeIntrinsicsPrior(calibration, free, calibration_sigma), camera)) {
      LogInfo(text);
    } else {
      solution->warnings.push_back(text + "; calibrate the camera again");
    }
  }
}

}  // namespace velamap
