// From the map of two frames to the map of all: frames and markers in turn, adjusted again and
// again.

#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/global/map_problem.h"

namespace velamap {

struct MapGrowthOptions {
  int min_num_inliers = 2;  // markers that have to agree for a frame to join
  int max_num_frames = 0;   // stop at so many registered frames; 0: all
  bool adjust = true;       // after every round; a precise map can do without
  std::uint32_t random_seed = 0;
};

// Registers those of `frame_idxs` that can be. Frames that see most of the map come first; a small
// map takes at most as many at a time as it already has. Ambiguous ones wait until nothing else is
// left. Frames that failed are tried again whenever the map has grown.
void GrowMap(const MapProblem& problem, const std::vector<int>& frame_idxs,
             const MapGrowthOptions& options, MapSolution* solution);

// Places markers anew by the consensus of all registered frames, but those that are where at least
// `settled_ratio` of the frames that see them have them.
void PlaceUnsettledMarkers(const MapProblem& problem, double settled_ratio, double tolerance_factor,
                           MapSolution* solution);

// Whether a marker has one place, and at least `settled_ratio` of the registered frames that see
// it, two at least, agree with that.
bool IsSettled(const MapProblem& problem, const MapSolution& solution, int marker_idx,
               double settled_ratio);

}  // namespace velamap
