#include "exporters/scale/robust_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

#include "importer/base/error.h"
#include "importer/base/statistics.h"

namespace velamap {
namespace {

// Keeps rounding from making outliers where all values agree; they are of order 1.
constexpr double kRounding = 1e-9;

using Vector = Eigen::VectorXd;

// Weighted least squares; nothing where the design lacks rank.
std::optional<Vector> Solve(const Eigen::MatrixXd& design, const Vector& values,
                            const Vector& weights) {
  const Vector roots = weights.cwiseSqrt();
  const Eigen::MatrixXd weighted = roots.asDiagonal() * design;
  // Columns of the same length, so that the rank does not depend on their units.
  Vector lengths = weighted.colwise().norm();
  if (!(lengths.minCoeff() > 0)) return std::nullopt;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(weighted * lengths.cwiseInverse().asDiagonal());
  qr.setThreshold(1e-9);
  if (qr.rank() < design.cols()) return std::nullopt;
  const Vector scaled = qr.solve(roots.cwiseProduct(values));
  return Vector(scaled.cwiseQuotient(lengths));
}

double RobustSize(const Vector& normalised, Eigen::Index num_coefficients) {
  std::vector<double> sizes(normalised.data(), normalised.data() + normalised.size());
  for (double& size : sizes) size = std::abs(size);
  const double n = static_cast<double>(normalised.size());
  const double p = static_cast<double>(num_coefficients);
  return 1.4826 * Median(std::move(sizes)) * std::sqrt(n / (n - p));
}

Vector TotalSigmas(const Vector& sigmas, double excess_sigma) {
  return (sigmas.array().square() + excess_sigma * excess_sigma + kRounding * kRounding).sqrt();
}

double ExcessSigma(const Vector& residuals, const Vector& sigmas, Eigen::Index num_coefficients) {
  if (residuals.size() <= num_coefficients) return 0.0;
  const auto size_at = [&](double excess_sigma) {
    return RobustSize(residuals.cwiseQuotient(TotalSigmas(sigmas, excess_sigma)), num_coefficients);
  };
  if (size_at(0.0) <= 1.0) return 0.0;
  double low = 0.0, high = RobustSize(residuals, num_coefficients);  // right where no own sigma is
  constexpr int kNumHalvings = 60;
  for (int i = 0; i < kNumHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (size_at(middle) > 1.0 ? low : high) = middle;
  }
  return high;
}

// Least sum of absolute residuals by reweighting, near enough for a start.
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
    fit.num_used = static_cast<int>(is_used.count());
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
  mean.num_used = fit->num_used;
  return mean;
}

}  // namespace velamap
