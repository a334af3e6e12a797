// Principal axes of a set of points; the axis of least spread is the normal of its least-squares
// plane.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace velamap {

struct PrincipalAxes {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d directions = Eigen::Matrix3d::Identity();   // columns by ascending spread
  Eigen::Vector3d sums_of_squares = Eigen::Vector3d::Zero();  // along each direction
};

// `scatter` is the sum of (x - mean) (x - mean)^T over the points x.
PrincipalAxes AxesOfScatter(const Eigen::Vector3d& mean, const Eigen::Matrix3d& scatter);

// `points` must not be empty.
PrincipalAxes ComputePrincipalAxes(const std::vector<Eigen::Vector3d>& points);

}  // namespace velamap
