// Decides whether a video shows a rolling shutter, and warns if it is implausibly slow.

#pragma once

#include "reconstruct/adjust/marker_solution.h"
#include "reconstruct/model/adjustment_uncertainty.h"

namespace velamap {

// Tries the time from the first row to the last as a parameter of a solution that holds it. Returns
// true if the square of the estimate over its sigma, which contains the correlation of errors,
// exceeds the Bayesian information criterion (Schwarz 1978) for one parameter, and if the time is
// at least as long as sensors take. Returns false without motions of the corners, without
// estimate_rolling_shutter, where the option gives the time, and where the trial fails.
bool ShowsRollingShutter(const MarkerSolution& solution);

// Adds a warning where the rows take longer to read than any camera needs.
void WarnOfSlowShutter(const AdjustmentUncertainty& uncertainty, MarkerSolution* solution);

}  // namespace velamap
