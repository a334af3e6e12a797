// A line or a mean through values that have a noise of their own, a common scatter beyond it that
// is not known, and outliers.

#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace velamap {

struct RobustFit {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd covariance;  // of the coefficients
  // 1 sigma of the values beyond their own: what makes the robust standard deviation of the
  // normalised residuals 1; 0 where their own explains all.
  double excess_sigma = 0.0;
  // Residual / root of (own sigma^2 + excess^2), by value. Beyond 3: an outlier, not used.
  Eigen::VectorXd sigmas_off;
  int num_used = 0;
};

constexpr double kMaxRobustSigmas = 3.0;

// values = design * coefficients + noise; `sigmas` are the values' own, 0 where unknown. Starts
// from the least sum of absolute residuals. Nothing where there are fewer values than coefficients,
// or where the values that are used do not determine them.
std::optional<RobustFit> FitRobustly(const Eigen::MatrixXd& design, const Eigen::VectorXd& values,
                                     const Eigen::VectorXd& sigmas);

struct RobustMean {
  double mean = 0.0;
  std::optional<double> sigma;  // of the mean; nothing for a single value without a sigma
  double excess_sigma = 0.0;
  std::vector<double> sigmas_off;
  int num_used = 0;
};

// The same of a constant. `values` must not be empty; `sigmas` as above.
RobustMean FitMeanRobustly(const std::vector<double>& values, const std::vector<double>& sigmas);

}  // namespace velamap
