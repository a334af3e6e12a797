#include "exporters/freeform/field_regression.h"

#include <cmath>
#include <utility>

#include "importer/base/error.h"

namespace velamap {
namespace {

// The prior of the polynomial's coefficients. In normalized coordinates they are of the order of 1.
constexpr double kDriftSigma = 10.0;
// The likelihood uses a subset of the rows, which determines the amplitude well enough, because the
// time of one evaluation grows with the third power of their number.
constexpr Eigen::Index kMaxLikelihoodRows = 600;

double RowCovariance(const FieldRows& rows, Eigen::Index i, Eigen::Index j) {
  const Eigen::RowVector3d d = rows.places.row(i) - rows.places.row(j);
  const double r = d.norm();
  const bool i_is_value = rows.IsValue(i), j_is_value = rows.IsValue(j);
  if (i_is_value && j_is_value) return ThinPlateCovariance(r);
  if (i_is_value) return -ThinPlateSlope(r) * d.dot(rows.directions.row(j));
  if (j_is_value) return ThinPlateSlope(r) * d.dot(rows.directions.row(i));
  const double along_i = d.dot(rows.directions.row(i)), along_j = d.dot(rows.directions.row(j));
  return -ThinPlateSlope(r) * rows.directions.row(i).dot(rows.directions.row(j)) -
         (r > 0 ? 6 * along_i * along_j / r : 0.0);
}

Eigen::MatrixXd UnitCovariance(const FieldRows& rows) {
  Eigen::MatrixXd covariance(rows.Size(), rows.Size());
  for (Eigen::Index j = 0; j < rows.Size(); ++j) {
    for (Eigen::Index i = j; i < rows.Size(); ++i) {
      covariance(i, j) = covariance(j, i) = RowCovariance(rows, i, j);
    }
  }
  return covariance;
}

Eigen::MatrixXd DriftOf(const FieldRows& rows) {
  Eigen::MatrixXd drift(rows.Size(), kNumDrift);
  for (Eigen::Index i = 0; i < rows.Size(); ++i) {
    const Eigen::Vector3d x = rows.places.row(i);
    if (rows.IsValue(i)) {
      drift.row(i) = DriftValue(x);
    } else {
      drift.row(i) = rows.directions.row(i) * DriftGradient(x);
    }
  }
  return drift;
}

double LogDeterminant(const Eigen::LLT<Eigen::MatrixXd>& factor) {
  return 2 * factor.matrixLLT().diagonal().array().log().sum();
}

// Rasmussen and Williams, section 2.7, with a finite prior covariance of the polynomial.
FieldSolution SolveWithMatrices(const Eigen::MatrixXd& unit_covariance,
                                const Eigen::MatrixXd& drift, const Eigen::VectorXd& targets,
                                const Eigen::VectorXd& sigmas, double amplitude) {
  FieldSolution solution;
  Eigen::MatrixXd covariance = amplitude * amplitude * unit_covariance;
  covariance.diagonal() += sigmas.cwiseAbs2();
  solution.covariance.compute(covariance);
  VELAMAP_CHECK(solution.covariance.info() == Eigen::Success);
  const auto lower = solution.covariance.matrixL();
  solution.whitened_drift = lower.solve(drift);
  const Eigen::VectorXd whitened_targets = lower.solve(targets);
  Eigen::MatrixXd precision = solution.whitened_drift.transpose() * solution.whitened_drift;
  precision.diagonal().array() += 1 / (kDriftSigma * kDriftSigma);
  solution.drift_precision.compute(precision);
  solution.drift =
      solution.drift_precision.solve(solution.whitened_drift.transpose() * whitened_targets);
  const Eigen::VectorXd residuals = whitened_targets - solution.whitened_drift * solution.drift;
  solution.weights = amplitude * amplitude * solution.covariance.matrixU().solve(residuals);
  solution.log_likelihood =
      -0.5 * (LogDeterminant(solution.covariance) + LogDeterminant(solution.drift_precision) +
              whitened_targets.dot(residuals));
  return solution;
}

// Golden-section search for the maximum of a function that has only one between `low` and `high`.
template <typename Function>
double Maximize(double low, double high, const Function& function) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr double kTolerance = 0.1;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double at_a = function(a), at_b = function(b);
  while (high - low > kTolerance) {
    if (at_a > at_b) {
      high = std::exchange(b, a), at_b = at_a;
      a = high - kGolden * (high - low), at_a = function(a);
    } else {
      low = std::exchange(a, b), at_a = at_b;
      b = low + kGolden * (high - low), at_b = function(b);
    }
  }
  return (low + high) / 2;
}

}  // namespace

FieldSolution SolveField(const FieldRows& rows, const Eigen::VectorXd& sigmas, double amplitude) {
  return SolveWithMatrices(UnitCovariance(rows), DriftOf(rows), rows.targets, sigmas, amplitude);
}

FieldParameters MaximizeLikelihood(const FieldRows& all, const Eigen::VectorXd& all_sigmas,
                                   bool sigmas_are_known) {
  // Takes every k-th row, of points and normals alike, so that at most kMaxLikelihoodRows remain.
  const Eigen::Index step = (all.Size() + kMaxLikelihoodRows - 1) / kMaxLikelihoodRows;
  const auto chosen = Eigen::seq(0, all.Size() - 1, step);
  const FieldRows rows = {all.places(chosen, Eigen::all), all.directions(chosen, Eigen::all),
                          all.targets(chosen)};
  const Eigen::MatrixXd covariance = UnitCovariance(rows), drift = DriftOf(rows);
  const auto log_likelihood = [&](double log_amplitude, double log_factor) {
    Eigen::VectorXd sigmas = all_sigmas(chosen);
    for (Eigen::Index i = 0; i < rows.Size(); ++i) {
      if (rows.IsValue(i)) sigmas(i) *= std::exp(log_factor);
    }
    return SolveWithMatrices(covariance, drift, rows.targets, sigmas, std::exp(log_amplitude))
        .log_likelihood;
  };
  double log_amplitude = std::log(1e-2), log_factor = 0.0;
  for (int round = 0; round < (sigmas_are_known ? 1 : 4); ++round) {
    log_amplitude =
        Maximize(std::log(1e-5), 0.0, [&](double x) { return log_likelihood(x, log_factor); });
    if (sigmas_are_known) break;
    log_factor = Maximize(std::log(1e-2), std::log(1e2),
                          [&](double x) { return log_likelihood(log_amplitude, x); });
  }
  return {std::exp(log_amplitude), std::exp(log_factor)};
}

}  // namespace velamap
