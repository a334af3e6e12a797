// Resection of one frame: its pose by the consensus of all known corners that it sees.

#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/map/map_problem.h"

namespace velamap {

struct PoseHypothesis {
  Rigid3 cam_from_shape;
  double cost = 0.0;                  // see ResectFrame
  std::vector<int> observation_idxs;  // that agree with it
};

// At most three distinct poses, the best first. Hypotheses come from single markers (each with its
// planar solutions) and from corners of three markers (P3P); they are ranked by a truncated sum of
// squares, in which an observation beyond `tolerance_factor` * GrowthTolerance counts 1, and
// refined. Empty where the frame sees no known marker.
std::vector<PoseHypothesis> ResectFrame(const MapProblem& problem, const MapSolution& solution,
                                        int frame_idx, double tolerance_factor,
                                        std::uint32_t random_seed);

// Whether the second hypothesis explains the frame nearly as well as the first, so that other
// frames should join the map first.
bool IsAmbiguous(const std::vector<PoseHypothesis>& hypotheses);

}  // namespace velamap
