// Where a map begins: pairs of frames that look at many common markers from different directions.

#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "reconstruct/global/map_problem.h"

namespace velamap {

// Pairs of `frame_idxs`, the most promising first: by the number of common markers, in full from a
// parallax of 20 degrees on. A frame starts once only, so that a bad one spoils one start.
std::vector<std::pair<int, int>> ChooseStartPairs(const MapProblem& problem,
                                                  const std::vector<int>& frame_idxs,
                                                  int max_num_pairs, int min_num_shared);

// The map of two frames, in the cam frame of the first; of several hypotheses for their relative
// pose, and the reversed relief of each, the one that explains most. Not registered where none
// does.
MapSolution StartFromPair(const MapProblem& problem, const std::pair<int, int>& pair,
                          std::uint32_t random_seed);

// How much a solution explains: a sum over all observations that is 1 for a perfect one and falls
// to 0 at the tolerance. More is better.
double ExplainedObservations(const MapProblem& problem, const MapSolution& solution);

// The solution seen inside out: every depth mirrored at the plane of the markers, cameras turned
// along with it. Where perspective is weak both explain the images nearly equally well, and an
// adjustment does not find its way from one to the other.
MapSolution ReversedRelief(const MapSolution& solution);

}  // namespace velamap
