// Robust least squares of one frame's pose against known markers, and of one marker's place against
// known frames: the small steps between adjustments of the whole map. Residuals are in sigmas, with
// a Cauchy loss over the corners of an observation together.

#pragma once

#include <vector>

#include "importer/geometry/least_squares.h"
#include "reconstruct/map/map_problem.h"

namespace velamap {

// How far a marker's side may be from the nominal one, 1 sigma of its logarithm.
constexpr double kScaleSigma = 0.02;

// Observations beyond this many sigmas lose weight.
constexpr double kLossSigmas = 4.0;

// An observation together with the place of its marker.
struct PlacedObservation {
  const MapObservation* observation;
  const Sim3* shape_from_marker;
};

// cam_from_shape of one frame, as a problem of MinimizeSquares(). Steps are as in PlusPose().
struct FramePoseProblem : LeastSquaresProblem<6> {
  using Parameters = Rigid3;

  const MapProblem& problem;
  const std::vector<PlacedObservation>& observations;

  FramePoseProblem(const MapProblem& map, const std::vector<PlacedObservation>& placed)
      : problem(map), observations(placed) {}
  void Evaluate(const Rigid3& cam_from_shape, bool, Equations* equations) const;
  Rigid3 Plus(const Rigid3& pose, const Step& step) const;
};

// shape_from_marker of one marker; a step is rotation vector, translation and the logarithm of the
// scale, which a prior holds near 0.
struct MarkerPlaceProblem : LeastSquaresProblem<7> {
  using Parameters = Sim3;

  const MapProblem& problem;
  const MapSolution& solution;
  const std::vector<int>& observation_idxs;

  MarkerPlaceProblem(const MapProblem& map, const MapSolution& frames, const std::vector<int>& idxs)
      : problem(map), solution(frames), observation_idxs(idxs) {}
  void Evaluate(const Sim3& place, bool, Equations* equations) const;
  Sim3 Plus(const Sim3& place, const Step& step) const;
};

Rigid3 RefineFramePose(const MapProblem& problem,
                       const std::vector<PlacedObservation>& observations,
                       const Rigid3& cam_from_shape);

// `observation_idxs` are of one marker, in frames that are registered.
Sim3 RefineMarkerPlace(const MapProblem& problem, const MapSolution& solution,
                       const std::vector<int>& observation_idxs, const Sim3& shape_from_marker);

}  // namespace velamap
