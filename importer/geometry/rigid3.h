// Rigid and similarity transforms. Names spell both frames, target first, so that compositions
// check by eye: c_from_a = c_from_b * b_from_a, because the inner names touch.

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace velamap {

// x_in_b = rotation * x_in_a + translation.
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x_in_a) const {
    return rotation * x_in_a + translation;
  }
};

inline Rigid3 operator*(const Rigid3& c_from_b, const Rigid3& b_from_a) {
  return {(c_from_b.rotation * b_from_a.rotation).normalized(),
          c_from_b.rotation * b_from_a.translation + c_from_b.translation};
}

inline Rigid3 Inverse(const Rigid3& b_from_a) {
  const Eigen::Quaterniond a_from_b_rotation = b_from_a.rotation.conjugate();
  return {a_from_b_rotation, -(a_from_b_rotation * b_from_a.translation)};
}

// Angle of the rotation that takes one orientation to the other, rad.
inline double AngularDistance(const Rigid3& a, const Rigid3& b) {
  return a.rotation.angularDistance(b.rotation);
}

// x_in_b = scale * (rotation * x_in_a) + translation.
struct Sim3 {
  double scale = 1.0;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x_in_a) const {
    return scale * (rotation * x_in_a) + translation;
  }
};

}  // namespace velamap
