// From the normal equations of a marker problem to what its user is told. Private to this room.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "reconstruct/adjust/marker_problem.h"
#include "reconstruct/adjust/normal_equations.h"
#include "reconstruct/model/adjustment_uncertainty.h"

namespace velamap {

// Of all corners, in order of the parameters.
std::vector<Eigen::Vector3d> Positions(const MarkerState& state);

// Of all corners, in the frame that the first image's camera fixes.
PointCovariance PointsOf(const MarkerState& state, const MarkerCovariance& covariance);

// Number of residuals of the corners that no parameter absorbs.
double CornerRedundancy(const MarkerProblem& problem, const MarkerCovariance& covariance);

// All but the variance factor. `weights` and `problem` are those of `state`, without loss.
AdjustmentUncertainty MakeUncertainty(const MarkerState& state, const MarkerWeights& weights,
                                      const MarkerProblem& problem,
                                      const MarkerCovariance& covariance);

}  // namespace velamap
