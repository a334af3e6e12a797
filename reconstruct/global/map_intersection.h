// One marker against the registered frames: its place by consensus of all that see it.

#pragma once

#include <vector>

#include "reconstruct/global/map_problem.h"

namespace velamap {

struct PlaceHypothesis {
  Sim3 shape_from_marker;
  double cost = 0.0;
  std::vector<int> observation_idxs;  // those that agree with it
};

struct MarkerPlacement {
  // The place that most frames support, with a rival that explains the same frames nearly as well
  // where there is one (the other planar solution). Empty: no two frames agree.
  std::vector<PlaceHypothesis> places;
  // Observations that agree on another place, without those that agree on the best one: the same id
  // twice.
  std::vector<int> elsewhere_idxs;
  int num_seen = 0;  // registered frames that see the marker
};

// Hypotheses are the marker's own solutions in the frames that see it and its corners triangulated
// from pairs of frames; they are ranked by a truncated sum of squares over all frames, and refined.
// A marker that one registered frame sees gets that frame's solutions.
MarkerPlacement PlaceMarker(const MapProblem& problem, const MapSolution& solution, int marker_idx,
                            double tolerance_factor);

}  // namespace velamap
