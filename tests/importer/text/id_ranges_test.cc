#include "importer/text/id_ranges.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(IdRanges, IdsAreShownAsRanges) {
  EXPECT_EQ(IdRanges({}), "none");
  EXPECT_EQ(IdRanges({4}), "4");
  EXPECT_EQ(IdRanges({0, 1, 2, 5, 7, 8}), "0-2 5 7-8");
  EXPECT_EQ(IdRanges({1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21}), "1 3 5 7 9 11 13 15 17 19 ...");
}

}  // namespace
}  // namespace velamap
