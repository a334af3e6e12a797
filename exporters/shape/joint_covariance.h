// Joint covariance of several reported figures.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// Covariance matrix of linear functions of the points, in the product of their units: what
// CovarianceOf() gives for every pair, in one go. Throws std::logic_error for a point that is not
// in `covariance`.
Eigen::MatrixXd JointCovarianceOf(const PointCovariance& covariance,
                                  const std::vector<PointGradient>& gradients);

}  // namespace velamap
