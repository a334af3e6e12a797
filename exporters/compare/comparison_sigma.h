// Covariances of differences between aligned shapes: linear propagation of the noise of both
// shapes, including its effect on the alignment.

#pragma once

#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "exporters/compare/shape_alignment.h"
#include "exporters/shape/marker_shape.h"
#include "importer/geometry/rigid3.h"
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

// Derivatives of the least-squares pose with respect to the corners of the alignment. A motion is a
// rotation about the mean of the corners, in units of 1 / their root mean square distance from it,
// and a translation, m; both in the frame of the reference.
class AlignmentSensitivity {
 public:
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  explicit AlignmentSensitivity(const Alignment& alignment);

  // d (direction . x) / d motion.
  Vector6d MotionGradient(const Eigen::Vector3d& x_in_reference_m,
                          const Eigen::Vector3d& direction) const;

  // d motion / d corner: each row of a matrix belongs to an axis of the reference. The reference's
  // errors enter with the opposite sign, which does not change a covariance.
  std::map<CornerId, Eigen::Matrix<double, 3, 6>> MotionByCorner() const;

  const Rigid3& ReferenceFromShape() const { return alignment_.reference_from_shape; }

  // Number of the six rigid motions that the equations do not determine, such as the rotations of a
  // sphere.
  int NumFreeDirections() const { return num_free_directions_; }

 private:
  const Alignment& alignment_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  double radius_m_ = 1.0;
  Eigen::Matrix<double, 6, 6> inverse_normal_ = Eigen::Matrix<double, 6, 6>::Zero();
  int num_free_directions_ = 0;
};

// Propagates the noise of one shape to places on it after the alignment, which the same noise
// changes. All corners enter the motion of the alignment, so the product of its derivatives with
// their covariance is computed once; a place then takes only the time of its own corners.
class AlignedNoise {
 public:
  // `covariance` belongs to the corners of one shape (`whose`) and is in the frame of that shape.
  // It and the alignment must outlive this object.
  AlignedNoise(const AlignmentSensitivity& sensitivity, ComparedShape whose,
               const PointCovariance& covariance);

  // Variance, m^2, of a place along a direction, both in the frame of the reference. `own` is the
  // derivative of the place along the direction with respect to its corners while the alignment is
  // held fixed. Returns nothing if the covariance lacks one of the corners.
  std::optional<double> VarianceAt(const Eigen::Vector3d& x_in_reference_m,
                                   const Eigen::Vector3d& direction,
                                   const CornerGradient& own) const;

  // Covariance of the centre of a marker, m^2, in the frame of the reference. Returns nothing if
  // the covariance lacks a corner of the marker or of the alignment.
  std::optional<Eigen::Matrix3d> CenterCovariance(const MarkerInReference& marker) const;

 private:
  // Joint covariance of several places. Column i of `by_motion` is the derivative of place i with
  // respect to the motion of the alignment.
  std::optional<Eigen::MatrixXd> CovarianceOfPlaces(const std::vector<CornerGradient>& own,
                                                    const Eigen::MatrixXd& by_motion) const;

  const AlignmentSensitivity sensitivity_;
  const PointCovariance& covariance_;
  Eigen::Quaterniond own_from_reference_;
  bool has_all_corners_ = true;
  Eigen::MatrixXd corners_with_motion_;  // covariances, 3n x 6
  Eigen::MatrixXd of_motion_ = Eigen::MatrixXd::Zero(6, 6);
};

// Covariance of (aligned centre - centre in the reference) of a whole marker, m^2, in the frame of
// the reference. `reference` is null for a surface, which counts as exact. Returns nothing if a
// covariance lacks a corner of the marker or of the alignment.
std::optional<Eigen::Matrix3d> DifferenceCovariance(const MarkerInReference& marker,
                                                    const AlignedNoise& shape,
                                                    const AlignedNoise* reference);

}  // namespace velamap
