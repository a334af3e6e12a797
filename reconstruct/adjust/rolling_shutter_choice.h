// Decides whether a video shows a rolling shutter, and warns if it is implausibly slow.

#pragma once

#include "reconstruct/adjust/marker_solution.h"
#include "reconstruct/model/adjustment_uncertainty.h"

namespace velamap {

// Frees the readout time (from the first row to the last) in a copy of a solution that holds it.
// Returns true if the square of the estimate over its sigma, which contains the correlation of
// errors, exceeds the Bayesian information criterion (Schwarz 1978) for one parameter, and the time
// is no shorter than that of real sensors. Returns false if there are no motions of the corners,
// estimate_rolling_shutter is off, the option gives the time, or the trial fails.
bool ShowsRollingShutter(const MarkerSolution& solution);

// Adds a warning if the readout takes longer than that of any camera.
void WarnOfSlowShutter(const AdjustmentUncertainty& uncertainty, MarkerSolution* solution);

}  // namespace velamap
