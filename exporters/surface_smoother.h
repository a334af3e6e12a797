// Penalised least squares of a tensor-product B-spline, and the choice of its smoothing.

#pragma once

#include <optional>
#include <vector>

#include "exporters/surface_parameters.h"

namespace velamap {

// How the weight of the penalty is chosen.
enum class Smoothing {
  kInterpolate,      // as small as the arithmetic bears
  kKnownSigma,       // Mallows' Cp; the weights are 1 / sigma^2
  kCrossValidation,  // generalised; only the ratios of the weights count
};

struct SmoothSurface {
  SplineSurface surface;
  double num_effective_parameters = 0.0;
};

// One weight an observation, positive.
SmoothSurface SmoothObservations(const SurfaceParameters& parameters,
                                 const std::vector<double>& weights, Smoothing smoothing);

}  // namespace velamap
