// Corrects the edge shifts that the image formation leaves unexplained, using the measured
// positions of inner edges.

#pragma once

#include "importer/formation/formation_state.h"

namespace velamap {

// A state with corrected shifts, and 1 sigma of the inset of the corners that the correction
// leaves.
struct BalancedEdges {
  FormationState state;
  double inset_sigma_px = 0.0;
};

// If no image formation describes the shape of the blurred edges, the best fit to all pixels leaves
// the inner edges shifted towards the dark or the light cells. Corrects the edge shift by the part
// of this residual shift that exceeds the scatter of the samples.
BalancedEdges WithBalancedEdges(const FormationState& state, const FitWorkers& workers);

// Inner edges and outlines both determine the size of the markers. They disagree if only one of
// them is moved: by the surroundings of a narrow quiet zone, by a noise filter that takes the zone
// for noise, or by a printer. If they disagree by more than the scatter of the samples, the corners
// are moved by a part of the difference: by two thirds of it where inner edges are clear, by little
// where the blur mixes small cells. Their 1 sigma follows from the part that is left.
BalancedEdges WithBalancedOutlines(const FormationState& state, const FitWorkers& workers);

}  // namespace velamap
