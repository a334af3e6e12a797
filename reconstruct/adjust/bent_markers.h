// Markers on curved surfaces: whether they bend, and what follows from it.

#pragma once

#include <vector>

#include "reconstruct/adjust/marker_solution.h"
#include "reconstruct/colmap/bundle_adjustment.h"

namespace velamap {

// Where markers bend with a curved surface, takes their sides for chords, moves their corners in
// the images to where a fit of the bent pattern would have found them (also those that `removed`
// lists), and minimizes. `solution` must have been minimized with hardly any weight on the printed
// sizes. If the option bent_markers leaves open whether markers bend and it would change the size
// by more than 0.05 %, the proportions of the markers and the residuals of the images decide, by
// the Bayesian information criterion; if they cannot, there is a warning where the change would
// exceed 1 sigma of the scale of the print.
void AdjustToBentMarkers(const std::vector<RemovedObservation>& removed, MarkerSolution* solution);

}  // namespace velamap
