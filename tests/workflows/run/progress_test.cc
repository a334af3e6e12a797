#include "workflows/run/progress.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(ProgressTest, TextTellsCountPercentRateAndTimeLeft) {
  EXPECT_EQ(ProgressText("reading", 100, 400, 10.0), "reading: 100/400, 25 %, 10.0/s, 30 s left");
  EXPECT_EQ(ProgressText("reading", 1, 1001, 10.0), "reading: 1/1001, 0 %, 0.1/s, 2 h 46 min left");
  EXPECT_EQ(ProgressText("reading", 10, 110, 10.0), "reading: 10/110, 9 %, 1.0/s, 1 min 40 s left");
}

TEST(ProgressTest, TextWithoutTotalOrBeginning) {
  EXPECT_EQ(ProgressText("reading", 20, 0, 10.0), "reading: 20, 2.0/s");
  EXPECT_EQ(ProgressText("reading", 0, 5, 10.0), "reading: 0/5, 0 %, 0.0/s");
}

TEST(ProgressTest, ContainerThatUnderstatesItsFramesStaysAtHundredPercent) {
  EXPECT_EQ(ProgressText("reading", 12, 10, 12.0), "reading: 12/10, 100 %, 1.0/s, 0 s left");
}

TEST(ProgressTest, BarFillsInProportion) {
  EXPECT_EQ(ProgressBar(0, 8, 4), "[    ] ");
  EXPECT_EQ(ProgressBar(4, 8, 4), "[##  ] ");
  EXPECT_EQ(ProgressBar(9, 8, 4), "[####] ");
  EXPECT_EQ(ProgressBar(9, 0, 4), "");
}

}  // namespace
}  // namespace velamap
