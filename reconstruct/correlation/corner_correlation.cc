#include "reconstruct/correlation/corner_correlation.h"

#include <algorithm>
#include <random>
#include <vector>

#include <ceres/cost_function.h>

#include "importer/base/ids.h"
#include "importer/base/log.h"
#include "reconstruct/problem/corner_whitening.h"

namespace velamap {
namespace {

constexpr double kMinCorrelation = -0.2, kMaxCorrelation = 0.5;
// The usual correlation counts as much as this many residuals of markers as a whole.
constexpr double kOfUsual = 10.0;
// Columns of simulated errors, which give the redundancies to 1 % where 1000 residuals are left.
constexpr Eigen::Index kNumDraws = 8;

// Squares of residuals of markers with four corners: of the mean of the corners and of their
// differences from it, so that independent errors of 1 sigma give as much per residual in both.
struct SplitSquares {
  double of_means = 0.0, of_differences = 0.0;
};

SplitSquares SumSplitSquares(const MarkerJacobian& jacobian, const RowMajorMatrix& residuals) {
  SplitSquares squares;
  Eigen::Index row = 0;
  for (const ResidualJacobian& view : jacobian.corners) {
    const auto of_view = residuals.middleRows(row, view.NumRows());
    row += view.NumRows();
    if (of_view.rows() != 2 * kNumCorners) continue;
    RowMajorMatrix means = of_view;  // in the place of each corner
    Whiten({1.0, 0.0}, means);
    const double of_means = means.squaredNorm();
    squares.of_means += of_means;
    squares.of_differences += of_view.squaredNorm() - of_means;
  }
  return squares;
}

// What the adjustment leaves of independent errors with a sigma of 1.
SplitSquares SimulateRedundancies(const MarkerJacobian& jacobian,
                                  const MarkerCovariance& covariance) {
  Eigen::Index num_rows = 0;
  for (const auto* blocks : {&jacobian.corners, &jacobian.priors}) {
    for (const ResidualJacobian& block : *blocks) num_rows += block.NumRows();
  }
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  RowMajorMatrix errors(num_rows, kNumDraws);
  for (double& error : errors.reshaped()) error = normal(random);
  const SplitSquares sums = SumSplitSquares(jacobian, ErrorsLeft(jacobian, covariance, errors));
  return {sums.of_means / kNumDraws, sums.of_differences / kNumDraws};
}

// Calls `change` with the errors of each view, two rows for each of its corners, their sigmas, and
// the whitening.
template <typename Change>
void ForEachView(const MarkerProblem& problem, RowMajorMatrix* errors, const Change& change) {
  Eigen::Index row = 0;
  for (const ceres::ResidualBlockId view : problem.corner_residuals) {
    const int num_rows = problem.ceres->GetCostFunctionForResidualBlock(view)->num_residuals();
    Eigen::VectorXd sigmas_px(num_rows);
    for (Eigen::Index i = 0; i < num_rows; ++i) {
      sigmas_px[i] = problem.corner_sigmas_px[static_cast<std::size_t>((row + i) / 2)];
    }
    auto of_view = errors->middleRows(row, num_rows);
    change(sigmas_px, CornerWhitening::Of(problem.corner_correlation, num_rows / 2), of_view);
    row += num_rows;
  }
}

}  // namespace

double EstimateCornerCorrelation(const MarkerProblem& problem, const MarkerJacobian& jacobian,
                                 const MarkerCovariance& covariance) {
  const std::vector<double> residuals = CornerResiduals(problem);
  const SplitSquares found =
      SumSplitSquares(jacobian, Eigen::Map<const Eigen::VectorXd>(
                                    residuals.data(), static_cast<Eigen::Index>(residuals.size())));
  const SplitSquares redundancies = SimulateRedundancies(jacobian, covariance);
  if (!(redundancies.of_means > 0 && redundancies.of_differences > 0)) {
    return kUsualCornerCorrelation;
  }
  const double before = problem.corner_correlation;
  const double of_means =
      (1.0 + (kNumCorners - 1) * before) * found.of_means / redundancies.of_means;
  const double of_differences = (1.0 - before) * found.of_differences / redundancies.of_differences;
  if (!(of_means + of_differences > 0)) return kUsualCornerCorrelation;  // exact corners
  const double by_residuals =
      (of_means - of_differences) / (of_means + (kNumCorners - 1) * of_differences);
  const double correlation =
      (redundancies.of_means * by_residuals + kOfUsual * kUsualCornerCorrelation) /
      (redundancies.of_means + kOfUsual);
  LogDebug("corners of a marker correlate by {:.3f}", correlation);
  return std::clamp(correlation, kMinCorrelation, kMaxCorrelation);
}

void PixelsToResiduals(const MarkerProblem& problem, RowMajorMatrix* errors) {
  ForEachView(
      problem, errors,
      [](const Eigen::VectorXd& sigmas_px, const CornerWhitening& whitening, auto& of_view) {
        of_view.array().colwise() /= sigmas_px.array();
        Whiten(whitening, of_view);
      });
}

void ResidualsToPixels(const MarkerProblem& problem, RowMajorMatrix* errors) {
  ForEachView(
      problem, errors,
      [](const Eigen::VectorXd& sigmas_px, const CornerWhitening& whitening, auto& of_view) {
        Whiten(whitening.Inverse(), of_view);
        of_view.array().colwise() *= sigmas_px.array();
      });
}

}  // namespace velamap
