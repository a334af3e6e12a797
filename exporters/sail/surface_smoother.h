// Penalised least squares of a tensor-product B-spline, and the choice of its smoothing.

#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "exporters/sail/surface_parameters.h"

namespace velamap {

// How the weight of the penalty is chosen.
enum class Smoothing {
  kInterpolate,  // as small as the arithmetic bears
  // Mallows' Cp; the weights are 1 / sigma^2. Of kMinCrossValidated observations or more it is
  // never closer than cross-validation finds right.
  kKnownSigma,
  kCrossValidation,  // generalised; only the ratios of the weights count
};

constexpr std::size_t kMinCrossValidated = 30;  // fewer tell too little of the noise

struct SmoothSurface {
  SplineSurface surface;
  double num_effective_parameters = 0.0;
};

// One weight an observation, positive.
SmoothSurface SmoothObservations(const SurfaceParameters& parameters,
                                 const std::vector<double>& weights, Smoothing smoothing);

}  // namespace velamap
