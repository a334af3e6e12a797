// How well differences between aligned shapes are known: the noise of both, and what it does to the
// alignment, propagated linearly.

#pragma once

#include <map>
#include <optional>

#include <Eigen/Core>

#include "exporters/compare/shape_alignment.h"
#include "exporters/shape/marker_shape.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// The covariance that the sigmas of a shape.csv allow for, where the joint one is not at hand: the
// errors of a marker's corners are a part that is common to them, as the sigma of its centre says,
// and a part of each corner's own; axes and markers are independent. What markers have in common,
// such as the scale and long waves of the shape, is missing. Points without a sigma are left out.
PointCovariance CovarianceFromSigmas(const MarkerShape& shape);

// The least-squares pose as a function of the corners it was made of.
class AlignmentSensitivity {
 public:
  explicit AlignmentSensitivity(const Alignment& alignment);

  // Of (aligned centre - centre in the reference) of a marker that is whole, m^2, reference frame.
  // `reference` is null for a surface, which is taken as exact. Nothing where a corner of the
  // marker or of those that the alignment is made of is not in a covariance.
  std::optional<Eigen::Matrix3d> DifferenceCovariance(int marker_id,
                                                      const Eigen::Vector3d& center_in_reference_m,
                                                      const PointCovariance& shape,
                                                      const PointCovariance* reference) const;

  // Rigid motions that the equations leave open, such as the turns of a sphere: of six.
  int NumFreeDirections() const { return num_free_directions_; }

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  // d (direction . x) / d (turn, shift), the turn about center_ in units of 1 / radius_m_.
  Vector6d MotionGradient(const Eigen::Vector3d& x_in_reference_m,
                          const Eigen::Vector3d& direction) const;
  // Of direction . (aligned centre), by the errors of the aligned corners.
  std::map<CornerId, Eigen::Vector3d> CenterGradient(int marker_id,
                                                     const Eigen::Vector3d& center_in_reference_m,
                                                     const Eigen::Vector3d& direction) const;

  const Alignment& alignment_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  double radius_m_ = 1.0;
  Eigen::Matrix<double, 6, 6> inverse_normal_ = Eigen::Matrix<double, 6, 6>::Zero();
  int num_free_directions_ = 0;
};

}  // namespace velamap
