// Covariances of differences between aligned shapes: linear propagation of the noise of both
// shapes, including its effect on the alignment.

#pragma once

#include <map>
#include <optional>

#include <Eigen/Core>

#include "exporters/compare/shape_alignment.h"
#include "exporters/shape/marker_shape.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// Approximates the covariance by the sigmas of a shape.csv if the joint one is not available. The
// errors of a marker's corners have a common part, given by the sigma of the centre, and an
// individual part; axes and markers are independent. Errors that markers share, such as the scale
// and long waves of the shape, are missing. Points without a sigma are left out.
PointCovariance CovarianceFromSigmas(const MarkerShape& shape);

// A whole marker of the shape in the frame of the reference.
struct MarkerInReference {
  int marker_id = 0;
  Eigen::Vector3d center_in_reference_m = Eigen::Vector3d::Zero();
};

// The derivative of a function with respect to each corner, frame of the reference.
using CornerGradient = std::map<CornerId, Eigen::Vector3d>;

// Which of the two shapes a covariance belongs to.
enum class ComparedShape { kShape, kReference };

// Derivatives of the least-squares pose with respect to the corners of the alignment.
class AlignmentSensitivity {
 public:
  explicit AlignmentSensitivity(const Alignment& alignment);

  // Covariance of (aligned centre - centre in the reference) of a whole marker, m^2, in the frame
  // of the reference. `reference` is null for a surface, which counts as exact. Nothing if a
  // covariance lacks a corner of the marker or of the alignment.
  std::optional<Eigen::Matrix3d> DifferenceCovariance(const MarkerInReference& marker,
                                                      const PointCovariance& shape,
                                                      const PointCovariance* reference) const;

  // Variance, m^2, of a point on one shape along a direction, from the noise of that shape; point
  // and direction are in the frame of the reference. `own` is the gradient of the point along the
  // direction for a fixed alignment. Nothing if the covariance lacks one of the corners.
  std::optional<double> VarianceAt(const Eigen::Vector3d& x_in_reference_m,
                                   const Eigen::Vector3d& direction, CornerGradient own,
                                   ComparedShape whose, const PointCovariance& covariance) const;

  // Number of the six rigid motions that the equations do not determine, such as the rotations of a
  // sphere.
  int NumFreeDirections() const { return num_free_directions_; }

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  // d (direction . x) / d (rotation, translation), with the rotation about center_ in units of
  // 1 / radius_m_.
  Vector6d MotionGradient(const Eigen::Vector3d& x_in_reference_m,
                          const Eigen::Vector3d& direction) const;
  // Adds the effect of the corners on the alignment to the gradient of direction . x, where x is a
  // point of the aligned shape.
  void AddAlignment(const Eigen::Vector3d& x_in_reference_m, const Eigen::Vector3d& direction,
                    CornerGradient* gradient) const;
  // Converts the gradient to the frame of the shape whose corners it refers to. The reference's
  // errors enter with the opposite sign, which does not change a covariance.
  PointGradient InFrameOf(ComparedShape whose, const CornerGradient& gradient) const;
  // Covariance of the centre of a marker, from the noise of one shape.
  std::optional<Eigen::Matrix3d> CenterCovariance(const MarkerInReference& marker,
                                                  ComparedShape whose,
                                                  const PointCovariance& covariance) const;

  const Alignment& alignment_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  double radius_m_ = 1.0;
  Eigen::Matrix<double, 6, 6> inverse_normal_ = Eigen::Matrix<double, 6, 6>::Zero();
  int num_free_directions_ = 0;
};

}  // namespace velamap
