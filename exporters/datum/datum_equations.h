// Points of the shape whose coordinates are known in another frame, and the equations that they
// give for the transformation into it: residual = known_from_shape * x - known coordinate, one for
// each coordinate that is given.

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "importer/geometry/rigid3.h"

namespace velamap {

struct DatumPoint {
  Eigen::Vector3d x_m;  // along the axes of the shape frame, from DatumPoints::center_in_shape_m
  std::array<std::optional<double>, 3> known_m;
  double sigma_m = 0.0;  // of each known coordinate
};

struct DatumPoints {
  std::vector<DatumPoint> points;
  Eigen::Vector3d center_in_shape_m = Eigen::Vector3d::Zero();  // mean of the points
  double radius_m = 1.0;                                        // rms distance from the centre
  // 3n x 3n, of the positions in the shape; 0 where it is not known.
  Eigen::MatrixXd covariance_m2;
};

// Ascending indices of points.
using PointSet = std::vector<std::size_t>;
PointSet AllOf(const DatumPoints& points);

// Equations of a set of points at a pose, point by point and along x, y, z.
struct DatumEquations {
  std::vector<Eigen::Index> begins;  // of the rows of each point of the set, and the end of all
  Eigen::VectorXd residuals_m;
  // By a turn about the centre (a rotation vector applied on the left, times the radius) and a
  // shift, both in m.
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_pose;
  Eigen::VectorXd by_scale_m;  // by a relative change of the size of the shape
};

// The pose takes x_m of the points to the known frame.
DatumEquations Linearize(const DatumPoints& points, const PointSet& set, const Rigid3& pose);

// Covariance of the residuals, from the known coordinates and from the shape.
Eigen::MatrixXd ResidualCovariance(const DatumPoints& points, const PointSet& set,
                                   const Eigen::Quaterniond& known_from_shape);

}  // namespace velamap
