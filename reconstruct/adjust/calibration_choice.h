// Decides whether the images contradict the calibration, and which intrinsics they determine
// better.

#pragma once

#include <optional>

#include "reconstruct/adjust/marker_solution.h"
#include "reconstruct/geometry/intrinsics_prior.h"

namespace velamap {

struct RefinedIntrinsics {
  FreeIntrinsics free;
  // 1 sigma of the prior, as a fraction. It is larger than for an ordinary calibration, because the
  // images contradict this one.
  double sigma = 0.0;
};

// Chooses the intrinsics to free in a solution that holds the calibration. Returns nothing unless
// the sum of squares falls by more than the Bayesian information criterion (Schwarz 1978), times
// the square of the factor of correlated errors, and the images determine these intrinsics clearly
// better than the calibration does. Also returns nothing if refine_calibration is off or the
// options already free intrinsics.
std::optional<RefinedIntrinsics> ChooseIntrinsics(const MarkerSolution& solution);

// Reports how far the cameras of the solution are from their calibration: in the log if
// `calibration_sigma` explains it, else as a warning.
void ReportRefinement(const FreeIntrinsics& free, double calibration_sigma,
                      MarkerSolution* solution);

}  // namespace velamap
