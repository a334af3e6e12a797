// Penalized least squares of a tensor-product B-spline, and the choice of its smoothing.

#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "exporters/sail/surface_parameters.h"

namespace velamap {

// How the weight of the penalty is chosen.
enum class Smoothing {
  kInterpolate,  // the smallest weight that double precision allows
  // Mallows' Cp, with weights of 1 / sigma^2. With kMinCrossValidated observations or more, the
  // penalty is at least that of cross-validation.
  kKnownSigma,
  kCrossValidation,  // generalized; only the ratios of the weights count
};

constexpr std::size_t kMinCrossValidated = 30;  // fewer do not determine the noise

struct SmoothSurface {
  SplineSurface surface;
  double num_effective_parameters = 0.0;
};

// Takes one positive weight per observation. Throws DataError if the equations have no solution in
// double precision.
SmoothSurface SmoothObservations(const SurfaceParameters& parameters,
                                 const std::vector<double>& weights, Smoothing smoothing);

}  // namespace velamap
