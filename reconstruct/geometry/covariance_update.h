// Operations on the joint covariance of all points.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// Updates the covariance by independent measurements of linear functions of the points (Kalman's
// update). `gradients` is 3n x m, `sigmas` m. Appends m columns with sign -1.
void AddMeasurements(const Eigen::MatrixXd& gradients, const Eigen::VectorXd& sigmas,
                     PointCovariance* covariance);

// C * vectors, 3n x m.
Eigen::MatrixXd Multiply(const PointCovariance& covariance, const Eigen::MatrixXd& vectors);

// Sum of all variances, m^2.
double Trace(const PointCovariance& covariance);

// An orthonormal basis of the infinitesimal rigid motions of the points, 3n x 6 (fewer columns
// where they lie on a line).
Eigen::MatrixXd RigidMotions(const std::vector<Eigen::Vector3d>& x_in_world);

// The covariance after a least-squares alignment (rotation and translation) of all points with
// their true places: P C P, where P projects out the six infinitesimal rigid motions of the points
// `x_in_world` (Baarda's S-transformation to inner constraints). Appends up to 12 columns.
void ToInnerConstraints(const std::vector<Eigen::Vector3d>& x_in_world,
                        PointCovariance* covariance);

// d(scale)/d(points), 3n, for the scale of the least-squares similarity from `x_in_world` to moved
// points, at zero motion: x - centroid, divided by the sum of its squares.
Eigen::VectorXd ScaleGradient(const std::vector<Eigen::Vector3d>& x_in_world);

}  // namespace velamap
