#include "importer/text/number_text.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(FixedText, LittleBelowZeroIsZero) {
  EXPECT_EQ(FixedText(-0.04, 1), "0.0");
  EXPECT_EQ(FixedText(-0.06, 1), "-0.1");
  EXPECT_EQ(FixedText(-0.4, 0), "0");
  EXPECT_EQ(FixedText(-1204.56, 1), "-1204.6");
  EXPECT_EQ(FixedText(10, 2), "10.00");
}

TEST(UncertainText, NoSigmaIsRoundedToZero) {
  EXPECT_EQ(UncertainText(0.0312, 0.0011, 1000, 1, "+-"), "31.2 +- 1.1");
  EXPECT_EQ(UncertainText(0.0312, std::nullopt, 1000, 1, "+-"), "31.2");
  EXPECT_EQ(UncertainText(8.01234, 0.004, 1, 1, "±"), "8.012 ± 0.004");
}

TEST(UncertainText, HasSixDecimalsAtMost) {
  EXPECT_EQ(UncertainText(8.0123456, 6e-7, 1, 1, "±"), "8.012346 ± 0.000001");
  EXPECT_EQ(UncertainText(8.0123456, 4e-7, 1, 1, "±"), "8.0 ± 0.0");
}

TEST(UncertainText, ASigmaOfZeroChangesNothing) {
  EXPECT_EQ(UncertainText(-1e-12, 0, 1, 1, "±"), "0.0 ± 0.0");
}

}  // namespace
}  // namespace velamap
