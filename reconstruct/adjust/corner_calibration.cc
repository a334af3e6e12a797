#include "reconstruct/adjust/corner_calibration.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "importer/base/log.h"
#include "reconstruct/correlation/corner_correlation.h"
#include "reconstruct/problem/marker_uncertainty.h"

namespace velamap {
namespace {

// Exact corners would leave no weight to the priors.
constexpr double kMinCornerFactor = 1e-3;

// The factor of the corners' sigmas, from their variance factor before any factor. Few residuals
// may be small by chance, and a smaller factor would make them smaller still, so the detector's own
// sigmas count as much as kOfDetector residuals.
double CornerFactor(double variance_factor, double redundancy) {
  constexpr double kOfDetector = 4.0;
  return std::max(kMinCornerFactor, std::sqrt((variance_factor * redundancy + kOfDetector) /
                                              (redundancy + kOfDetector)));
}

}  // namespace

double CalibrateRobustly(MarkerSolution* solution) {
  const double before = solution->weights.corner_factor;
  const VarianceFactor variance =
      RobustVarianceFactor(ResidualsOfModel(solution->model, *solution), solution->model);
  const double after = CornerFactor(variance.value * before * before, variance.redundancy);
  solution->weights.corner_factor = after;
  LogDebug("corner sigmas times {:.4f}", after);
  return std::abs(after / before - 1.0);
}

CornerCalibration CalibrateBySquares(MarkerSolution* solution) {
  constexpr int kMaxNumRounds = 3;
  constexpr double kMaxChange = 0.01;
  constexpr double kManySigmas = 4.0;
  for (int round = 1; true; ++round) {
    Minimize(1e-9, solution);
    auto linearization = Linearize(*solution);
    const double redundancy =
        std::max(1.0, CornerRedundancy(linearization->jacobian, linearization->covariance));
    double sum = 0.0;
    const std::vector<CornerResidual> corners = EvaluateCorners(linearization->problem);
    for (const CornerResidual& corner : corners) sum += corner.sigmas * corner.sigmas;
    const double variance = sum / redundancy;
    const double before = solution->weights.corner_factor;
    const double factor = CornerFactor(variance * before * before, redundancy);
    const double correlation = EstimateCornerCorrelation(
        linearization->problem, linearization->jacobian, linearization->covariance);
    const double change = std::max(std::abs(factor / before - 1.0),
                                   std::abs(correlation - solution->weights.corner_correlation));
    if (round < kMaxNumRounds && change > kMaxChange) {
      solution->weights.corner_factor = factor;
      solution->weights.corner_correlation = correlation;
      continue;
    }
    const auto num_above =
        std::count_if(corners.begin(), corners.end(), [variance](const CornerResidual& corner) {
          return corner.sigmas > kManySigmas * std::sqrt(variance);
        });
    return {std::move(linearization), factor * factor,
            static_cast<double>(num_above) / static_cast<double>(corners.size())};
  }
}

}  // namespace velamap
