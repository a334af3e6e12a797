// Resection of one frame: its pose by the consensus of all known corners that it sees.

#pragma once

#include <cstdint>
#include <vector>

#include "importer/geometry/consensus_pose.h"
#include "reconstruct/map/map_problem.h"

namespace velamap {

// At most three distinct poses in the frame of the map, the best first; their inliers are
// observations of the problem. Hypotheses come from single markers (each with its planar solutions)
// and from corners of three markers (P3P); they are ranked by a truncated sum of squares, in which
// an observation beyond `tolerance_factor` * GrowthTolerance counts 1, and refined. Empty if the
// frame sees no known marker.
std::vector<PoseHypothesis> ResectFrame(const MapProblem& problem, const MapSolution& solution,
                                        int frame_idx, double tolerance_factor,
                                        std::uint32_t random_seed);

// Whether the second hypothesis explains nearly as much as the first: as many observations at up to
// twice the cost. For poses of a frame (PoseHypothesis) and places of a marker (PlaceHypothesis). A
// frame with an ambiguous pose should wait until other frames have joined the map.
template <typename Hypothesis>
bool IsAmbiguous(const std::vector<Hypothesis>& hypotheses) {
  // The small constant avoids comparing rounding errors.
  constexpr double kRatio = 2.0, kNegligible = 1e-3;
  if (hypotheses.size() < 2) return false;
  const Hypothesis &best = hypotheses[0], &rival = hypotheses[1];
  const double num_inliers = static_cast<double>(best.inlier_idxs.size());
  return rival.cost < kRatio * best.cost + kNegligible * num_inliers &&
         rival.inlier_idxs.size() >= best.inlier_idxs.size();
}

}  // namespace velamap
