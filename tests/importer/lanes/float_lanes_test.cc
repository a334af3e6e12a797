#include "importer/lanes/float_lanes.h"

#include <cmath>

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(FloatLanes, RoundCompareAndAdd) {
  const Floats x = {-1.5f, -1.0f, 0.25f, 7.0f, 0.0f, -0.25f, 3.5f, 2.0f};
  const Ints floor = Floor(x);
  const Floats root = Sqrt(Abs(x));
  for (int lane = 0; lane < kLanes; ++lane) {
    EXPECT_EQ(floor[lane], static_cast<int>(std::floor(x[lane])));
    EXPECT_EQ(root[lane], std::sqrt(std::abs(x[lane])));
  }
  EXPECT_EQ(Sum(x), 10.0);
  EXPECT_EQ(MaxLane(x), 7.0f);
  EXPECT_EQ(MaxLane(-x), 1.5f);
  EXPECT_EQ(MinLane(x), -1.5f);
  for (int lane = 0; lane < kLanes; ++lane) {
    Ints counts{};
    counts[lane] = 3;
    EXPECT_EQ(MaxLane(counts), 3) << lane;
    EXPECT_EQ(MinLane(-counts), -3) << lane;
  }
  for (int count = 0; count <= kLanes; ++count) EXPECT_EQ(Sum(FirstLanes(count)), count);
}

}  // namespace
}  // namespace velamap
