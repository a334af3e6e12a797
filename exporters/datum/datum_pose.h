// Poses of a shape by known coordinates, by least squares.

#pragma once

#include <vector>

#include "exporters/datum/datum_equations.h"

namespace velamap {

// The inverse of the Cholesky factor of a covariance, which whitens residuals. Ignores correlations
// if rounding has made the matrix indefinite.
Eigen::MatrixXd Whitener(const Eigen::MatrixXd& covariance);

struct DatumPose {
  Rigid3 pose;
  double squared_sigmas = 0.0;  // sum of squared residuals over their variances
};

// The poses to which the search converges, the best first. More than one can fit where few
// coordinates are given: two points and a level allow a turn to either side. The errors of the
// points count as independent.
std::vector<DatumPose> FindPoses(const DatumPoints& points, const PointSet& set);

// The least-squares pose for the joint covariance; `pose` is the start.
DatumPose AdjustPose(const DatumPoints& points, const PointSet& set, Rigid3 pose);

}  // namespace velamap
