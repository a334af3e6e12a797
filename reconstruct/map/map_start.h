// Starts of a map: pairs of frames that see many common markers from different directions.

#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "reconstruct/map/map_problem.h"

namespace velamap {

// Pairs of `frame_idxs`, the most promising first: by the number of common markers, which counts in
// full from a parallax of 20 degrees on. No frame is in two pairs, so that a bad frame spoils one
// start only.
std::vector<std::pair<int, int>> ChooseStartPairs(const MapProblem& problem,
                                                  const std::vector<int>& frame_idxs,
                                                  int max_num_pairs, int min_num_shared);

// The map of two frames, in the cam frame of the first. Tries several hypotheses for their relative
// pose, and the reversed relief of each, and returns the map that explains most. Neither frame is
// registered where no hypothesis explains anything.
MapSolution StartFromPair(const MapProblem& problem, const std::pair<int, int>& pair,
                          std::uint32_t random_seed);

// How much a solution explains: the sum of a score over all observations, which is 1 for an error
// of 0 and falls to 0 at the tolerance.
double ExplainedObservations(const MapProblem& problem, const MapSolution& solution);

// The solution with reversed relief: all depths are mirrored at the plane of the markers, and the
// cameras rotated accordingly. If perspective is weak, both explain the images nearly equally well,
// and an adjustment does not lead from one to the other.
MapSolution ReversedRelief(const MapSolution& solution);

}  // namespace velamap
