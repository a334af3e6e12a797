#include "importer/text/id_ranges.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(IdRanges, IdsAreShownAsRanges) {
  EXPECT_EQ(IdRanges({}), "none");
  EXPECT_EQ(IdRanges({4}), "4");
  EXPECT_EQ(IdRanges({0, 1, 2, 5, 7, 8}), "0-2 5 7-8");
  EXPECT_EQ(IdRanges({1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21}), "1 3 5 7 9 11 13 15 17 19 ...");
}

TEST(IdRanges, ARangeRunsUpOrDown) {
  using testing::ElementsAre;
  using testing::Optional;
  EXPECT_THAT(ParseIdRange("7"), Optional(ElementsAre(7)));
  EXPECT_THAT(ParseIdRange("9-12"), Optional(ElementsAre(9, 10, 11, 12)));
  EXPECT_THAT(ParseIdRange("2-0"), Optional(ElementsAre(2, 1, 0)));
  EXPECT_THAT(ParseIdRange("5-5"), Optional(ElementsAre(5)));
  EXPECT_THAT(ParseIdRange("08-010"), Optional(ElementsAre(8, 9, 10)));
  EXPECT_THAT(ParseIdRange("0-8191"), Optional(testing::SizeIs(8192)));
  for (const char* text : {"", "-", "5-", "-5", "1-2-3", "3--5", "a-b", "1.5-2", "1 - 2", "1-2,4",
                           "8192", "3-8192", "3-99999999999"}) {
    EXPECT_EQ(ParseIdRange(text), std::nullopt) << text;
  }
}

TEST(IdRanges, AListHasCommas) {
  EXPECT_THAT(ParseIdList("3,17,21-19"),
              testing::Optional(testing::ElementsAre(3, 17, 21, 20, 19)));
  for (const char* text : {"", ",", "3,", "3, 4", "3;4", "3,-4", "3,4-", "3,,4"}) {
    EXPECT_EQ(ParseIdList(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace velamap
