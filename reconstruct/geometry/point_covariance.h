// The joint covariance of all points of a metric model, in memory linear in the number of points: a
// block for every marker plus a part of low rank that couples all points through the cameras, the
// scale and the choice of the frame.
//
//   cov(x) = blockdiag(blocks) + factor * diag(signs) * factor^T,   signs are +1 or -1
//
// Rows run over the points in order, x y z each, world frame, m.

#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "importer/base/ids.h"

namespace velamap {

struct PointCovariance {
  std::vector<Point3DId> point3D_ids;   // ascending, so that corners of a marker are adjacent
  std::vector<Eigen::MatrixXd> blocks;  // by marker, 3c x 3c for its c points, m^2
  Eigen::MatrixXd factor;               // 3n x k, m
  Eigen::VectorXd signs;                // k

  bool IsEmpty() const { return point3D_ids.empty(); }
  // Index of the point in point3D_ids, or -1.
  int IndexOf(Point3DId point3D_id) const;
};

// A linear function of points: the derivative of a reported quantity with respect to each point
// (per m).
using PointGradient = std::vector<std::pair<Point3DId, Eigen::Vector3d>>;

// Covariance of two linear functions, in the product of their units. Throws std::logic_error for
// points that are not in `covariance`.
double CovarianceOf(const PointCovariance& covariance, const PointGradient& a,
                    const PointGradient& b);

// Never negative: rounding errors are cut off at zero.
double VarianceOf(const PointCovariance& covariance, const PointGradient& gradient);

// Joint 3x3 covariance of one point, m^2.
Eigen::Matrix3d PointCovarianceOf(const PointCovariance& covariance, Point3DId point3D_id);

// The covariance of these points only; ids that it does not have are ignored.
PointCovariance Subset(const PointCovariance& covariance, const std::vector<Point3DId>& ids);

}  // namespace velamap
