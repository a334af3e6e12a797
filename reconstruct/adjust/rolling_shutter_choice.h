// Whether the frames of a video show that their rows are read one after another.

#pragma once

#include "reconstruct/adjust/marker_solution.h"

namespace velamap {

// Frees the time from the first row to the last of a solution that holds it. True if the images
// determine it and the corners fit better by more than the Bayesian information criterion (Schwarz
// 1978) and the errors that corners have in common explain, and it is at least as long as sensors
// take. False without velocities of the corners, without estimate_rolling_shutter, and where the
// option gives the time.
bool ShowsRollingShutter(const MarkerSolution& solution);

}  // namespace velamap
