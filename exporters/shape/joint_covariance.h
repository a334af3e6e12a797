// Joint covariance of several figures.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "importer/base/ids.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// Covariance matrix of linear functions of the points: CovarianceOf() for every pair, at a lower
// cost. Throws std::logic_error for a point that `covariance` lacks.
Eigen::MatrixXd JointCovarianceOf(const PointCovariance& covariance,
                                  const std::vector<PointGradient>& gradients);

// Joint covariance of corners (1..4) and centres (0), three rows for each, m^2, with zeros for
// those that `covariance` (may be null) lacks.
Eigen::MatrixXd JointCovarianceOfPoints(const PointCovariance* covariance,
                                        const std::vector<CornerId>& points);

}  // namespace velamap
