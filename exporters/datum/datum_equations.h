// Points of the shape with known coordinates in another frame, and the linearized equations for the
// pose known_from_centred, which maps DatumPoint::x_m, relative to the centre of the points, to
// that frame. Each given coordinate gives one residual, the coordinate of known_from_centred * x_m
// minus the known one.

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "importer/geometry/rigid3.h"

namespace velamap {

struct DatumPoint {
  Eigen::Vector3d x_m;  // in the shape frame, relative to DatumPoints::center_in_shape_m
  std::array<std::optional<double>, 3> known_m;  // in the known frame
  double sigma_m = 0.0;                          // of each known coordinate

  // Returns nothing unless all three coordinates are known.
  std::optional<Eigen::Vector3d> KnownPosition() const;
};

struct DatumPoints {
  std::vector<DatumPoint> points;
  Eigen::Vector3d center_in_shape_m = Eigen::Vector3d::Zero();  // mean of the points
  double radius_m = 1.0;                                        // RMS distance from the centre
  // 3n x 3n, of the positions in the shape frame; 0 for points without a covariance.
  Eigen::MatrixXd covariance_m2;
};

// Ascending indices into DatumPoints::points.
using PointSet = std::vector<std::size_t>;

constexpr int kNumPoseParameters = 6;

// The number of known coordinates, each of which gives an equation.
int NumCoordinates(const DatumPoints& points, const PointSet& set);

// The equations of a set of points at a pose, in the order of the points and of x, y, z.
struct DatumEquations {
  std::vector<Eigen::Index> begins;  // first row of each point of the set, then the number of rows
  Eigen::VectorXd residuals_m;
  // Derivatives with respect to a step of the pose, m: a rotation vector that is applied on the
  // left, times the radius, then a translation.
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_pose;
  // Derivatives with respect to a relative change of the size of the shape.
  Eigen::VectorXd by_scale_m;
};

DatumEquations LinearizeDatum(const DatumPoints& points, const PointSet& set,
                              const Rigid3& known_from_centred);

// The covariance of the residuals, m^2, due to the errors of the known coordinates and of the
// shape.
Eigen::MatrixXd ResidualCovariance(const DatumPoints& points, const PointSet& set,
                                   const Eigen::Quaterniond& known_from_centred);

}  // namespace velamap
