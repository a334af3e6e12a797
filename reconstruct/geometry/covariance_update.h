// What changes a covariance of points as a whole.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// The covariance once linear functions of the points have been measured too, with independent
// errors. `gradients` is 3n x m, `sigmas` m. (Kalman's update; m more columns with sign -1.)
void AddMeasurements(const Eigen::MatrixXd& gradients, const Eigen::VectorXd& sigmas,
                     PointCovariance* covariance);

// C * vectors, 3n x m.
Eigen::MatrixXd Multiply(const PointCovariance& covariance, const Eigen::MatrixXd& vectors);

// Sum of all variances, m^2.
double Trace(const PointCovariance& covariance);

// Orthonormal, 3n x 6: the infinitesimal rigid motions of the points (fewer columns where they lie
// on a line).
Eigen::MatrixXd RigidMotions(const std::vector<Eigen::Vector3d>& x_in_world);

// The covariance after a least-squares alignment (rotation and translation) of all points with
// their true places: P C P, where P projects out the six infinitesimal rigid motions of the points
// `x_in_world` (Baarda's S-transformation to inner constraints). Up to 12 more columns.
void ToInnerConstraints(const std::vector<Eigen::Vector3d>& x_in_world,
                        PointCovariance* covariance);

// d(scale)/d(points) for the scale of a least-squares similarity of the points to where they are:
// x - centroid over the sum of its squares, 3n.
Eigen::VectorXd ScaleGradient(const std::vector<Eigen::Vector3d>& x_in_world);

}  // namespace velamap
