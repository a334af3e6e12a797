// Robust least squares of one frame's pose against known markers, and of one marker's place against
// known frames: the small steps between adjustments of the whole map.

#pragma once

#include <vector>

#include "reconstruct/global/map_problem.h"

namespace velamap {

// How far a marker's side may be from the nominal one, 1 sigma of its logarithm.
constexpr double kScaleSigma = 0.02;

// An observation together with the place of its marker.
struct PlacedObservation {
  const MapObservation* observation;
  const Sim3* shape_from_marker;
};

// Levenberg-Marquardt with a Cauchy loss, the rotation perturbed on the left.
Rigid3 RefineFramePose(const MapProblem& problem,
                       const std::vector<PlacedObservation>& observations,
                       const Rigid3& cam_from_shape);

// The same for a similarity; `observations` are of one marker, in frames that are registered.
Sim3 RefineMarkerPlace(const MapProblem& problem, const MapSolution& solution,
                       const std::vector<int>& observation_idxs, const Sim3& shape_from_marker);

}  // namespace velamap
