#include "importer/geometry/directions.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

TEST(AngleBetween, IsExactForSmallAndLargeAngles) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  EXPECT_NEAR(AngleBetween(3 * x, {2, 2e-9, 0}), 1e-9, 1e-15);
  EXPECT_NEAR(AngleBetween(x, {0, 0, 5}), kPi / 2, 1e-15);
  EXPECT_NEAR(AngleBetween(x, {-1, 0, 1e-9}), kPi - 1e-9, 1e-15);
}

TEST(CubeRotations, AreTwentyFourDifferentRotations) {
  const std::vector<Eigen::Matrix3d> rotations = CubeRotations();
  ASSERT_EQ(rotations.size(), 24u);
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    EXPECT_TRUE((rotations[i] * rotations[i].transpose()).isIdentity(0.0));
    EXPECT_EQ(rotations[i].determinant(), 1);
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(rotations[i], rotations[j]);
  }
}

}  // namespace
}  // namespace velamap
