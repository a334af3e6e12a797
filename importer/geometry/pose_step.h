// Steps of a pose in the small Gauss-Newton problems of this room: first the turn, a rotation
// vector on the left, then the shift. Derivatives are of rays (x/z, y/z). Private to this room.

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "importer/geometry/rigid3.h"

namespace velamap {

using PoseStep = Eigen::Matrix<double, 6, 1>;

// CrossMatrix(a) * b = a x b.
inline Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& a) {
  Eigen::Matrix3d matrix;
  matrix << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return matrix;
}

inline Eigen::Matrix<double, 2, 3> RayFromPoint(const Eigen::Vector3d& x_in_cam) {
  const double inverse = 1 / x_in_cam.z();
  Eigen::Matrix<double, 2, 3> ray_from_x;
  ray_from_x << inverse, 0, -x_in_cam.x() * inverse * inverse, 0, inverse,
      -x_in_cam.y() * inverse * inverse;
  return ray_from_x;
}

// Derivative by a turn of a point at `rotated`, from that of whatever by the point: each row r
// becomes rotated x r.
inline Eigen::Matrix<double, 2, 3> ByTurn(const Eigen::Matrix<double, 2, 3>& by_point,
                                          const Eigen::Vector3d& rotated) {
  Eigen::Matrix<double, 2, 3> by_turn;
  by_turn.row(0) = rotated.cross(by_point.row(0));
  by_turn.row(1) = rotated.cross(by_point.row(1));
  return by_turn;
}

// Derivative of the ray of rotated + translation.
inline Eigen::Matrix<double, 2, 6> RayFromPoseStep(const Eigen::Vector3d& rotated,
                                                   const Eigen::Vector3d& x_in_cam) {
  const Eigen::Matrix<double, 2, 3> ray_from_x = RayFromPoint(x_in_cam);
  Eigen::Matrix<double, 2, 6> ray_from_step;
  ray_from_step << ByTurn(ray_from_x, rotated), ray_from_x;
  return ray_from_step;
}

// Derivative of q x by a unit quaternion q = (v, w), in the order x y z w, from
// q x = x + 2 w (v x x) + 2 v x (v x x).
inline Eigen::Matrix<double, 3, 4> RotatedFromQuaternion(const Eigen::Quaterniond& q,
                                                         const Eigen::Vector3d& x) {
  const Eigen::Vector3d v = q.vec();
  Eigen::Matrix<double, 3, 4> jacobian;
  jacobian.leftCols<3>() = 2.0 * (v.dot(x) * Eigen::Matrix3d::Identity() + v * x.transpose() -
                                  2.0 * x * v.transpose() - q.w() * CrossMatrix(x));
  jacobian.col(3) = 2.0 * v.cross(x);
  return jacobian;
}

inline Eigen::Quaterniond Turned(const Eigen::Vector3d& turn, const Eigen::Quaterniond& rotation) {
  const double angle = turn.norm();
  if (!(angle > 0)) return rotation;
  return (Eigen::AngleAxisd(angle, turn / angle) * rotation).normalized();
}

inline Rigid3 Moved(const Rigid3& pose, const PoseStep& step) {
  return {Turned(step.head<3>(), pose.rotation), pose.translation + step.tail<3>()};
}

}  // namespace velamap
