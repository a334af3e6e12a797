#include "workflows/run/report_input.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(ReportTitle, IsTheNameThatTheUserGave) {
  EXPECT_EQ(ReportTitle("/data/tuesday/clip.mp4"), "clip.mp4");
  EXPECT_EQ(ReportTitle("/data/cube"), "cube");
  EXPECT_EQ(ReportTitle("/data/cube/images"), "cube");
  EXPECT_EQ(ReportTitle("/images"), "images");
}

}  // namespace
}  // namespace velamap
