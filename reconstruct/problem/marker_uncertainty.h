// Converts the covariance of a marker problem into the uncertainty reported to users.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/problem/marker_problem.h"
#include "reconstruct/problem/normal_equations.h"
#include "reconstruct/problem/scale_bar.h"

namespace velamap {

// Positions of all corners, in the order of the parameters.
std::vector<Eigen::Vector3d> Positions(const MarkerState& state);

// Covariance of all corners in the frame of the first image's camera.
PointCovariance PointsOf(const MarkerState& state, const MarkerCovariance& covariance);

// Covariance of the bars' lengths in the state, m^2, where the scale of the print is known: noise
// of the corners, tolerance of single prints, scales of parts. `covariance` does not contain the
// bars.
Eigen::MatrixXd BarCovariance(const std::vector<ScaleBar>& bars, const MarkerState& state,
                              const MarkerProblem& problem, const MarkerCovariance& covariance);

// First column of a block of global parameters; -1 where it does not vary.
int GlobalColumn(const MarkerProblem& problem, const double* block);

// Covariance of one global parameter block that varies, in its tangent space.
Eigen::MatrixXd GlobalCovariance(const MarkerProblem& problem, const MarkerCovariance& covariance,
                                 const double* block);

// Number of the corners' residuals minus the number of parameters that they determine.
double CornerRedundancy(const MarkerJacobian& jacobian, const MarkerCovariance& covariance);

// Everything but the variance factor, the correlation factor and the share of large residuals.
// `weights` and `problem` belong to `state` and have no loss.
AdjustmentUncertainty MakeUncertainty(const MarkerAdjustmentOptions& options,
                                      const MarkerState& state, const MarkerWeights& weights,
                                      const MarkerProblem& problem,
                                      const MarkerCovariance& covariance);

}  // namespace velamap
