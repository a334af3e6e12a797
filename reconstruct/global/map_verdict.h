// Judgement of a finished map: how precise it is, what does not belong in it, and why.

#pragma once

#include <string>
#include <vector>

#include "reconstruct/global/map_problem.h"

namespace velamap {

struct MapNoise {
  // Robust standard deviation of a coordinate of a corner in units of its sigma_px: in the map, and
  // in single frames (0: not registered).
  double factor = 1.0;
  std::vector<double> factor_of_frame;  // by frame_idx
  // The same in px, and what markers say when each is posed alone: that is the noise of corners
  // whatever the shape is. The map's own is larger where the shape is wrong, or bends meanwhile.
  double sigma_px = 0.0;
  double alone_sigma_px = 0.0;
};

// From the observations that fit.
MapNoise EstimateNoise(const MapProblem& problem, const MapSolution& solution);

// Error up to which an observation belongs to the finished map, px.
double FinalTolerance(const MapObservation& observation, const MapNoise& noise);

void MarkFinalFits(const MapProblem& problem, const MapNoise& noise, MapSolution* solution);

// Whether the errors are larger than the noise of the corners explains: the sign of a wrong shape.
bool IsSuspicious(const MapNoise& noise);

// Why an observation does not fit its marker's place: the id of another marker, corners numbered
// from a wrong one, a single corner, or something else.
std::string WhyOutlier(const MapProblem& problem, const MapSolution& solution,
                       const MapNoise& noise, const MapObservation& observation);

}  // namespace velamap
