// Whether the images contradict the calibration, and which intrinsics they determine better.

#pragma once

#include <optional>

#include "reconstruct/adjust/marker_solution.h"
#include "reconstruct/geometry/intrinsics_prior.h"

namespace velamap {

struct RefinedIntrinsics {
  FreeIntrinsics free;
  // Of the prior: a calibration that the images contradict counts less than an ordinary one.
  double sigma = 0.0;
};

// Frees the intrinsics of a solution that holds the calibration. Nothing unless the sum of squares
// falls by more than the Bayesian information criterion (Schwarz 1978) and the errors that corners
// have in common explain, or unless the images determine what they need clearly better than the
// calibration does. Nothing without refine_calibration either, or where the options free
// intrinsics.
std::optional<RefinedIntrinsics> ChooseIntrinsics(const MarkerSolution& solution);

// Says how far the cameras of the solution are from their calibration: in the log where
// `calibration_sigma` explains it, else as a warning.
void ReportRefinement(const FreeIntrinsics& free, double calibration_sigma,
                      MarkerSolution* solution);

}  // namespace velamap
