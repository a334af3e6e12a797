#include "importer/lanes/normal_lanes.h"

#include <cmath>

#include <gtest/gtest.h>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

TEST(NormalAt, AgreesWithTheStandardLibrary) {
  for (double z = -7.0; z < 7.0; z += 0.01) {
    const NormalLanes found = NormalAt(AllLanes(z));
    EXPECT_NEAR(found.distribution[0], 0.5 * std::erfc(-z / std::sqrt(2.0)), 2e-6) << z;
    EXPECT_NEAR(found.density[0], std::exp(-0.5 * z * z) / std::sqrt(2 * kPi), 2e-6) << z;
  }
}

}  // namespace
}  // namespace velamap
