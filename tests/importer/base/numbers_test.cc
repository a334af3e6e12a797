#include "importer/base/numbers.h"

#include <string>

#include <gmock/gmock.h>

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::Optional;

TEST(Numbers, AreDecimalAndFillTheText) {
  int number = 0;
  EXPECT_TRUE(ParseNumber("010", &number));
  EXPECT_EQ(number, 10);
  EXPECT_TRUE(ParseNumber("-7", &number));
  EXPECT_EQ(number, -7);
  for (const std::string text : {"", " 1", "1 ", "1x", "0x10", "1.0", "+1", "99999999999"}) {
    EXPECT_FALSE(ParseNumber(text, &number)) << text;
    EXPECT_EQ(number, -7) << text;
  }
  double length = 0.0;
  EXPECT_TRUE(ParseNumber("2.5e-1", &length));
  EXPECT_EQ(length, 0.25);
  EXPECT_FALSE(ParseNumber("0,5", &length));
}

TEST(Numbers, ListsAreSeparatedByCommas) {
  EXPECT_THAT(ParseNumberList<int>("12"), Optional(ElementsAre(12)));
  EXPECT_THAT(ParseNumberList<int>("12,15,40"), Optional(ElementsAre(12, 15, 40)));
  for (const std::string text : {"", ",", "12,", ",12", "12,,15", "12, 15", "12;15"}) {
    EXPECT_EQ(ParseNumberList<int>(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace velamap
