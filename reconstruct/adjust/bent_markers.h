// Decides whether markers on a curved surface bend with it, and adjusts for the bend.

#pragma once

#include <vector>

#include "reconstruct/adjust/marker_solution.h"
#include "reconstruct/colmap/bundle_adjustment.h"

namespace velamap {

// If the markers bend with a curved surface, treats their sides as chords, moves their corners in
// the images (including those in `removed`) to where a fit of the bent pattern would have found
// them, and minimizes. `solution` must come from a minimization that gave hardly any weight to the
// printed sizes. If the option bent_markers leaves the question open and bending would change the
// size by more than 0.05 %, the proportions of the markers and the residuals of the images decide,
// by the Bayesian information criterion. If they cannot, and the change would exceed 1 sigma of the
// scale of the print, a warning is added.
void AdjustToBentMarkers(const std::vector<RemovedObservation>& removed, MarkerSolution* solution);

}  // namespace velamap
