// Pose of a camera from its position and the point that it looks at.

#pragma once

#include "importer/geometry/rigid3.h"

namespace velamap {

// cam_from_world of a camera at `position` that looks at `target` and is turned about its optical
// axis by `roll_rad` from the pose in which the world's `up` points upwards in its picture. It must
// not look along `up`.
inline Rigid3 LookAt(const Eigen::Vector3d& position, const Eigen::Vector3d& target,
                     double roll_rad = 0.0, const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ()) {
  const Eigen::Vector3d forward = (target - position).normalized();
  const Eigen::Vector3d right = forward.cross(up).normalized();
  Eigen::Matrix3d axes;
  axes << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  const Eigen::Quaterniond rotation =
      Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()) * Eigen::Quaterniond(axes);
  return {rotation, -(rotation * position)};
}

}  // namespace velamap
