// The shift of edges that no description of the camera explains, from the places of inner edges.

#pragma once

#include "importer/formation/formation_state.h"

namespace velamap {

// A state that shifts edges so far that inner edges lie where the model has them, and how well the
// inset of the corners is known by that.
struct BalancedEdges {
  FormationState state;
  double inset_sigma_px = 0.0;
};

// The best fit of all pixels may leave inner edges of both polarities beside their places where no
// description of the camera fits the shape of its edges. The shift then follows their places, as
// far as it exceeds the scatter of the samples.
BalancedEdges WithBalancedEdges(const FormationState& state, int num_threads);

}  // namespace velamap
