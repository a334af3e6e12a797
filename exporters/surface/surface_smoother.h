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
  kInterpolate,      // the smallest ones that double precision allows
  kKnownSigma,       // Mallows' Cp, with weights of 1 / sigma^2
  kCrossValidation,  // generalized; only the ratios of the weights count
};

// Fewer markers do not determine their noise. With more, the residuals are the better evidence:
// sigmas contain errors that markers share, such as the error of the scale, which do not make a
// surface rough.
constexpr std::size_t kMinCrossValidated = 30;

// A weighted sum of the points of an observation that the surface should have as well.
struct SurfaceTerm {
  std::size_t observation_idx = 0;
  std::vector<double> factors;  // by the observation's points
  double weight = 1.0;          // positive; 1 / sigma^2
};

// Weights of the penalties on bends along the lines and across them: the decimal logarithms of the
// ratios of the traces of penalty and data term.
struct SmoothingWeights {
  double along = 0.0, across = 0.0;
};

struct SmoothSurface {
  SplineSurface surface;
  SmoothingWeights weights;
  double num_effective_parameters = 0.0;
  // By term: the residual along the normal times the root of the weight, and how far the surface
  // follows the term (the diagonal of the hat matrix). Empty for parabolas and if interpolating.
  Eigen::VectorXd residuals, leverages;
  // Per coordinate of the poles, m^2, with the penalty as prior knowledge (Wahba, "Bayesian
  // confidence intervals for the cross-validated smoothing spline", 1983). Empty if interpolating.
  Eigen::MatrixXd pole_covariance_m2;
  // The two parts of it, for noise that the terms share: how far the poles follow each term (poles
  // x terms), and what does not come from their noise but from what the smoothing may have
  // flattened. Empty if interpolating.
  Eigen::MatrixXd pole_by_term, smoothing_covariance_m2;
};

// The share of each pole in a point of the surface; they sum to 1.
Eigen::RowVectorXd PoleShares(const SplineSurface& surface, double u, double v);

// Sigma of a smooth surface at a place along its normal, m; nothing if it interpolates.
std::optional<double> SigmaAt(const SplineSurface& surface,
                              const Eigen::MatrixXd& pole_covariance_m2, double u, double v);

// Searches for the weights around `near`, such as those found for nearly the same terms, or over
// their whole range if it is not given. Throws DataError if the equations have no solution in
// double precision.
SmoothSurface SmoothTerms(const SurfaceParameters& parameters,
                          const std::vector<SurfaceTerm>& terms, Smoothing smoothing,
                          const std::optional<SmoothingWeights>& near = std::nullopt);

}  // namespace velamap
