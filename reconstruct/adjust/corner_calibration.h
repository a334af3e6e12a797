// Calibrates the corners' sigmas: finds the factor that makes them agree with the residuals.

#pragma once

#include <memory>

#include "reconstruct/adjust/marker_solution.h"

namespace velamap {

// Sets the factor by the median residual of the solution, without minimizing. Returns the relative
// change.
double CalibrateRobustly(MarkerSolution* solution);

struct CornerCalibration {
  std::unique_ptr<const MarkerLinearization> linearization;
  double variance_factor = 0.0;      // of the corners' sigmas before any factor
  double share_above_4_sigma = 0.0;  // of the corners
};

// Minimizes and sets the factor by the sum of squares until it is stable.
CornerCalibration CalibrateBySquares(MarkerSolution* solution);

}  // namespace velamap
