#include "exporters/scale/robust_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

#include "importer/base/error.h"
#include "importer/base/statistics.h"

namespace velamap {
namespace {

// Tolerates rounding errors of values of order 1 if all of them agree.
constexpr double kRounding = 1e-9;

using Vector = Eigen::VectorXd;

// Weighted least squares; nothing if the design is rank deficient.
std::optional<Vector> Solve(const Eigen::MatrixXd& design, const Vector& values,
                            const Vector& weights) {
  const Vector roots = weights.cwiseSqrt();
  const Eigen::MatrixXd weighted = roots.asDiagonal() * design;
  // Normalized columns make the rank independent of their units.
  Vector lengths = weighted.colwise().norm();
  if (!(lengths.minCoeff() > 0)) return std::nullopt;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(weighted * lengths.cwiseInverse().asDiagonal());
  qr.setThreshold(1e-9);
  if (qr.rank() < design.cols()) return std::nullopt;
  const Vector scaled = qr.solve(roots.cwiseProduct(values));
  return Vector(scaled.cwiseQuotient(lengths));
}

double ResidualSigma(const Vector& residuals, Eigen::Index num_coefficients) {
  return RobustSigmaAboutZero({residuals.data(), residuals.data() + residuals.size()},
                              static_cast<double>(num_coefficients));
}

Vector TotalSigmas(const Vector& sigmas, double excess_sigma) {
  return (sigmas.array().square() + excess_sigma * excess_sigma + kRounding * kRounding).sqrt();
}

double ExcessSigma(const Vector& residuals, const Vector& sigmas, Eigen::Index num_coefficients) {
  if (residuals.size() <= num_coefficients) return 0.0;
  const auto size_at = [&](double excess_sigma) {
    return ResidualSigma(residuals.cwiseQuotient(TotalSigmas(sigmas, excess_sigma)),
                         num_coefficients);
  };
  if (size_at(0.0) <= 1.0) return 0.0;
  double low = 0.0, high = ResidualSigma(residuals, num_coefficients);  // exact for zero sigmas
  constexpr int kNumHalvings = 60;
  for (int i = 0; i < kNumHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (size_at(middle) > 1.0 ? low : high) = middle;
  }
  return high;
}

// Approximates the smallest sum of absolute residuals by iterative reweighting.
std::optional<Vector> SolveAbsolute(const Eigen::MatrixXd& design, const Vector& values) {
  Vector weights = Vector::Ones(values.size());
  std::optional<Vector> coefficients;
  constexpr int kNumRounds = 40;
  for (int round = 0; round < kNumRounds; ++round) {
    coefficients = Solve(design, values, weights);
    if (!coefficients) return std::nullopt;
    const Vector sizes = (values - design * *coefficients).cwiseAbs();
    const double floor = std::max(1e-4 * sizes.mean(), 1e-15);
    weights = sizes.cwiseMax(floor).cwiseInverse();
    weights /= weights.maxCoeff();
  }
  return coefficients;
}

}  // namespace

std::optional<RobustFit> FitRobustly(const Eigen::MatrixXd& design, const Vector& values,
                                     const Vector& sigmas) {
  VELAMAP_CHECK(design.rows() == values.size() && values.size() == sigmas.size());
  if (values.size() < design.cols()) return std::nullopt;
  std::optional<Vector> coefficients = SolveAbsolute(design, values);
  if (!coefficients) return std::nullopt;
  RobustFit fit;
  Vector weights;
  constexpr int kNumRounds = 10;
  for (int round = 0; round < kNumRounds; ++round) {
    const Vector residuals = values - design * *coefficients;
    fit.excess_sigma = ExcessSigma(residuals, sigmas, design.cols());
    const Vector total = TotalSigmas(sigmas, fit.excess_sigma);
    fit.sigmas_off = residuals.cwiseQuotient(total);
    const auto is_used = fit.sigmas_off.array().abs() <= kMaxRobustSigmas;
    weights = is_used.select(total.array().square().inverse(), 0.0);
    coefficients = Solve(design, values, weights);
    if (!coefficients) return std::nullopt;
  }
  fit.coefficients = *coefficients;
  const Vector lengths = (weights.cwiseSqrt().asDiagonal() * design).colwise().norm();
  const Vector inverse_lengths = lengths.cwiseInverse();
  const Eigen::MatrixXd scaled = design * inverse_lengths.asDiagonal();
  const Eigen::MatrixXd information = scaled.transpose() * weights.asDiagonal() * scaled;
  fit.covariance =
      inverse_lengths.asDiagonal() *
      information.llt().solve(Eigen::MatrixXd::Identity(design.cols(), design.cols())) *
      inverse_lengths.asDiagonal();
  return fit;
}

RobustMean FitMeanRobustly(const std::vector<double>& values, const std::vector<double>& sigmas) {
  VELAMAP_CHECK(!values.empty());
  const auto size = static_cast<Eigen::Index>(values.size());
  const std::optional<RobustFit> fit =
      FitRobustly(Eigen::MatrixXd::Ones(size, 1), Eigen::Map<const Vector>(values.data(), size),
                  Eigen::Map<const Vector>(sigmas.data(), size));
  VELAMAP_CHECK(fit.has_value());
  RobustMean mean;
  mean.mean = fit->coefficients[0];
  if (values.size() > 1 || sigmas[0] > 0) mean.sigma = std::sqrt(fit->covariance(0, 0));
  mean.excess_sigma = fit->excess_sigma;
  mean.sigmas_off.assign(fit->sigmas_off.data(), fit->sigmas_off.data() + size);
  return mean;
}

}  // namespace velamap
