// Robust linear fits of values with known noise, unknown common scatter, and outliers.

#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace velamap {

struct RobustFit {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd covariance;  // of the coefficients
  // Common sigma in addition to the sigmas of the values, such that the normalized residuals have a
  // robust standard deviation of 1; 0 if the sigmas of the values explain all scatter.
  double excess_sigma = 0.0;
  // Residual / sqrt(sigma^2 + excess_sigma^2) of each value. Values beyond kMaxRobustSigmas are
  // outliers, which the fit does not use.
  Eigen::VectorXd sigmas_off;
};

constexpr double kMaxRobustSigmas = 3.0;

// Fits values = design * coefficients + noise, starting from the smallest sum of absolute
// residuals. `sigmas` belong to the values; 0 is unknown. Returns nothing if there are fewer values
// than coefficients or if the used values do not determine the coefficients.
std::optional<RobustFit> FitRobustly(const Eigen::MatrixXd& design, const Eigen::VectorXd& values,
                                     const Eigen::VectorXd& sigmas);

struct RobustMean {
  double mean = 0.0;
  std::optional<double> sigma;  // of the mean; nothing for a single value without a sigma
  double excess_sigma = 0.0;
  std::vector<double> sigmas_off;
};

// Fits a constant in the same way. `values` must not be empty.
RobustMean FitMeanRobustly(const std::vector<double>& values, const std::vector<double>& sigmas);

}  // namespace velamap
