// The shifts of edges that no description of the camera explains, from the places of inner edges.

#pragma once

#include "importer/formation/formation_state.h"

namespace velamap {

// A state with corrected shifts, and 1 sigma of the inset of the corners that the correction
// leaves.
struct BalancedEdges {
  FormationState state;
  double inset_sigma_px = 0.0;
};

// The best fit of all pixels may leave inner edges of both polarities beside their places where no
// description of the camera fits the shape of its edges. The shift then follows their places, as
// far as it exceeds the scatter of the samples.
BalancedEdges WithBalancedEdges(const FormationState& state, int num_threads);

// Inner edges also tell how large the markers are. What lies around a narrow quiet zone, a noise
// filter that takes the zone for noise, or a printer may move the outlines of the black squares
// alone, or what is within. Where both contradict each other by more than the scatter of the
// samples, neither is known to be right: the corners lie in the middle, and half of the
// contradiction is 1 sigma.
BalancedEdges WithBalancedOutlines(const FormationState& state, int num_threads);

}  // namespace velamap
