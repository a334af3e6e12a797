// Penalized least squares of a tensor-product B-spline, and the choice of its smoothing: one weight
// for all bends along the lines and one for those across them, over the whole surface.

#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "exporters/surface/surface_parameters.h"

namespace velamap {

// How the weights of the penalties are chosen.
enum class Smoothing {
  kParabolas,        // the largest ones: profiles of the second degree along and across the lines
  kInterpolate,      // the least ones that double precision allows
  kKnownSigma,       // Mallows' Cp, with weights of 1 / sigma^2
  kCrossValidation,  // generalized; only the ratios of the weights count
};

// Fewer markers do not determine their noise. With more, the residuals are the better evidence:
// sigmas contain errors that markers share, such as the error of the scale, which do not make a
// surface rough.
constexpr std::size_t kMinCrossValidated = 30;

struct SmoothSurface {
  SplineSurface surface;
  double num_effective_parameters = 0.0;
  // Per coordinate of the poles, m^2, with the penalty as prior knowledge (Wahba, "Bayesian
  // confidence intervals for the cross-validated smoothing spline", 1983). Empty if interpolating.
  Eigen::MatrixXd pole_covariance_m2;
  // The two parts of it, for noise that the observations share: how far the poles follow each
  // observation (poles x observations, rows sum to 1), and what does not come from their noise but
  // from what the smoothing may have flattened. Empty if interpolating.
  Eigen::MatrixXd pole_by_observation, smoothing_covariance_m2;
};

// The share of each pole in a point of the surface; they sum to 1.
Eigen::RowVectorXd PoleShares(const SplineSurface& surface, double u, double v);

// Sigma of a smooth surface at a place along its normal, m; nothing if it interpolates.
std::optional<double> SigmaAt(const SplineSurface& surface,
                              const Eigen::MatrixXd& pole_covariance_m2, double u, double v);

// Takes one positive weight per observation. Throws DataError if the equations have no solution in
// double precision.
SmoothSurface SmoothObservations(const SurfaceParameters& parameters,
                                 const std::vector<double>& weights, Smoothing smoothing);

}  // namespace velamap
