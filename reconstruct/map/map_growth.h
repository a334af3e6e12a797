// Grows the map of two frames to the map of all: registers frames and places markers in turn, with
// adjustments in between.

#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/map/map_problem.h"

namespace velamap {

struct MapGrowthOptions {
  int min_num_inliers = 2;  // markers that have to agree for a frame to join
  int max_num_frames = 0;   // stop at this many registered frames; 0: all
  bool adjust = true;       // after every round; a precise map can do without
  std::uint32_t random_seed = 0;
  int num_threads = 1;  // 0: one per core; never changes the result
};

// Registers the frames of `frame_idxs` as far as possible. Frames that see most of the map come
// first; a small map takes at most as many at a time as it already has. Ambiguous frames wait until
// no others are left. Frames that failed are tried again whenever the map has grown.
void GrowMap(const MapProblem& problem, const std::vector<int>& frame_idxs,
             const MapGrowthOptions& options, MapSolution* solution);

// Places all markers that are not settled (see IsSettled) by the consensus of all registered
// frames. An observation agrees within `tolerance_factor` * GrowthTolerance().
void PlaceUnsettledMarkers(const MapProblem& problem, double settled_ratio, double tolerance_factor,
                           int num_threads, MapSolution* solution);

// Whether a marker has a single place that at least two of the registered frames that see it, and
// at least the share `settled_ratio` of them, agree with.
bool IsSettled(const MapProblem& problem, const MapSolution& solution, int marker_idx,
               double settled_ratio);

}  // namespace velamap
