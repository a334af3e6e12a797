// Joint covariance of several figures.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// Covariance matrix of linear functions of the points: CovarianceOf() for every pair, at a lower
// cost. Throws std::logic_error for a point that `covariance` lacks.
Eigen::MatrixXd JointCovarianceOf(const PointCovariance& covariance,
                                  const std::vector<PointGradient>& gradients);

}  // namespace velamap
