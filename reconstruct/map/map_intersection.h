// Intersection of one marker: its place by the consensus of all registered frames that see it.

#pragma once

#include <vector>

#include "reconstruct/map/map_problem.h"

namespace velamap {

struct PlaceHypothesis {
  Sim3 shape_from_marker;
  double cost = 0.0;
  std::vector<int> inlier_idxs;  // observations that agree with it
};

struct MarkerPlacement {
  // The place that most frames support, followed by a rival where one explains the frames nearly as
  // well (the other planar solution). Empty if no two frames agree.
  std::vector<PlaceHypothesis> places;
  // Observations that do not agree with the best place but agree on another one, as when the id
  // exists twice or was misread.
  std::vector<int> elsewhere_idxs;
  int num_seen = 0;  // registered frames that see the marker

  std::vector<Sim3> ShapeFromMarker() const;  // `places` as a MapSolution holds them
};

// Hypotheses are the planar solutions of the marker in the frames that see it and its corners
// triangulated from pairs of frames. They are ranked by a truncated sum of squares over all frames
// and refined. A marker that only one registered frame sees gets the planar solutions of that
// frame.
MarkerPlacement PlaceMarker(const MapProblem& problem, const MapSolution& solution, int marker_idx,
                            double tolerance_factor);

}  // namespace velamap
