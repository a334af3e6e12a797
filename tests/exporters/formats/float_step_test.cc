#include "exporters/formats/float_step.h"

#include <cmath>

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(FloatStep, IsThatOfFloatsFarFromTheOrigin) {
  const Eigen::Vector3d far_m(456789.0, -5423456.0, 312.0);
  const auto step_m = CoarseFloatStep_m({far_m, far_m + Eigen::Vector3d(3, 0, 6)});
  ASSERT_TRUE(step_m);
  const float y = 5423456.0f;
  EXPECT_GE(*step_m, std::nextafter(y, 2 * y) - y);
  EXPECT_LT(*step_m, 2 * (std::nextafter(y, 2 * y) - y));
}

TEST(FloatStep, NothingIsSaidOfAFrameNearTheObject) {
  EXPECT_FALSE(CoarseFloatStep_m({}));
  EXPECT_FALSE(CoarseFloatStep_m({{0, 0, 0}, {3, 1, 20}}));
  EXPECT_FALSE(CoarseFloatStep_m({{80, 0, 0}, {83, 1, 20}}));
  EXPECT_TRUE(CoarseFloatStep_m({{90, 0, 0}, {93, 1, 20}}));
  // No other frame would help an object of this size.
  EXPECT_FALSE(CoarseFloatStep_m({{0, 0, 0}, {300, 20, 30}}));
}

}  // namespace
}  // namespace velamap
