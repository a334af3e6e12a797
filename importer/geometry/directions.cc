#include "importer/geometry/directions.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace velamap {

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

std::vector<Eigen::Matrix3d> CubeRotations() {
  std::vector<Eigen::Matrix3d> rotations;
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();
      for (int i = 0; i < 3; ++i) {
        rotation(order[static_cast<std::size_t>(i)], i) = (signs >> i) % 2 == 0 ? 1.0 : -1.0;
      }
      if (rotation.determinant() > 0) rotations.push_back(rotation);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return rotations;
}

}  // namespace velamap
