// Steps of a pose in least squares, and the derivatives that go with them. A step of 6 is a
// rotation vector (rad), applied on the left, followed by a translation; a ray is (x/z, y/z).

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "importer/geometry/rigid3.h"

namespace velamap {

using PoseStep = Eigen::Matrix<double, 6, 1>;

// CrossMatrix(a) * b = cross(a, b).
inline Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& a) {
  Eigen::Matrix3d matrix;
  matrix << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return matrix;
}

// Derivative of the ray of a point with respect to the point.
inline Eigen::Matrix<double, 2, 3> RayByPoint(const Eigen::Vector3d& x_in_cam) {
  const double inverse = 1 / x_in_cam.z();
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << inverse, 0, -x_in_cam.x() * inverse * inverse, 0, inverse,
      -x_in_cam.y() * inverse * inverse;
  return jacobian;
}

// Chain rule for a rotation: given the derivative of a quantity with respect to the point R x,
// returns its derivative with respect to a rotation vector applied to R on the left. `rotated` is R
// x.
inline Eigen::Matrix<double, 2, 3> ByRotation(const Eigen::Matrix<double, 2, 3>& by_point,
                                              const Eigen::Vector3d& rotated) {
  Eigen::Matrix<double, 2, 3> by_rotation;
  by_rotation.row(0) = rotated.cross(by_point.row(0));
  by_rotation.row(1) = rotated.cross(by_point.row(1));
  return by_rotation;
}

// The same with respect to a step of the pose that moves x to R x + t.
inline Eigen::Matrix<double, 2, 6> ByPoseStep(const Eigen::Matrix<double, 2, 3>& by_point,
                                              const Eigen::Vector3d& rotated) {
  Eigen::Matrix<double, 2, 6> by_pose;
  by_pose << ByRotation(by_point, rotated), by_point;
  return by_pose;
}

// Derivative (3 x 4) of the rotated point R p with respect to the unit quaternion (x y z w) of R,
// from R p = p + 2 w cross(v, p) + 2 cross(v, cross(v, p)), where v = (x y z).
inline Eigen::Matrix<double, 3, 4> RotatedFromQuaternion(const Eigen::Quaterniond& q,
                                                         const Eigen::Vector3d& p) {
  const Eigen::Vector3d v = q.vec();
  Eigen::Matrix<double, 3, 4> jacobian;
  jacobian.leftCols<3>() = 2.0 * (v.dot(p) * Eigen::Matrix3d::Identity() + v * p.transpose() -
                                  2.0 * p * v.transpose() - q.w() * CrossMatrix(p));
  jacobian.col(3) = 2.0 * v.cross(p);
  return jacobian;
}

inline Eigen::Quaterniond PlusRotation(const Eigen::Quaterniond& rotation,
                                       const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (!(angle > 0)) return rotation;
  return (Eigen::AngleAxisd(angle, rotation_vector / angle) * rotation).normalized();
}

inline Rigid3 PlusPose(const Rigid3& pose, const PoseStep& step) {
  return {PlusRotation(pose.rotation, step.head<3>()), pose.translation + step.tail<3>()};
}

}  // namespace velamap
