// Least-squares poses of a shape from known coordinates.

#pragma once

#include <vector>

#include "exporters/datum/datum_equations.h"

namespace velamap {

// The inverse of the Cholesky factor of a covariance, by which residuals are multiplied to whiten
// them. If rounding has made the matrix indefinite, correlations are ignored.
Eigen::MatrixXd Whitener(const Eigen::MatrixXd& covariance);

struct DatumPose {
  Rigid3 known_from_centred;    // of DatumPoint::x_m, which is relative to the centre
  double squared_sigmas = 0.0;  // sum of the squared whitened residuals
};

// The distinct local minima that a search from many rotations finds, the best first. If few
// coordinates are given, several can fit: two points and a levelled third one allow two poses.
// Errors of the points are treated as independent. If three or more points that are not on one line
// have all coordinates, the closed form replaces the search and gives the only pose.
std::vector<DatumPose> FindPoses(const DatumPoints& points, const PointSet& set);

// The least-squares pose with the joint covariance of all coordinates, starting from
// `known_from_centred`.
DatumPose AdjustPose(const DatumPoints& points, const PointSet& set,
                     const Rigid3& known_from_centred);

}  // namespace velamap
