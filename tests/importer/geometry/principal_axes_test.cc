#include "importer/geometry/principal_axes.h"

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace velamap {
namespace {

TEST(PrincipalAxes, OfABoxAreItsSidesWhateverItsPose) {
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(0.4, -0.3, 0.8, 0.2).normalized();
  const Eigen::Vector3d middle(5, -7, 2), half_sides(0.5, 3, 1);
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d signs(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    corners.push_back(middle + rotation * half_sides.cwiseProduct(signs));
  }
  const PrincipalAxes axes = ComputePrincipalAxes(corners);
  EXPECT_LT((axes.mean - middle).norm(), 1e-12);
  EXPECT_LT((axes.sums_of_squares - Eigen::Vector3d(2, 8, 72)).norm(), 1e-12);
  for (const auto& [column, side] : {std::pair(0, 0), std::pair(1, 2), std::pair(2, 1)}) {
    const Eigen::Vector3d along = rotation * Eigen::Vector3d::Unit(side);
    EXPECT_NEAR(std::abs(axes.directions.col(column).dot(along)), 1.0, 1e-12) << column;
  }
}

TEST(PrincipalAxes, NeedAPoint) { EXPECT_THROW(ComputePrincipalAxes({}), std::logic_error); }

}  // namespace
}  // namespace velamap
