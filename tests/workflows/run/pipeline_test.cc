#include "workflows/run/pipeline.h"

#include <gtest/gtest.h>

#include "workflows/options/shared_options.h"

namespace velamap {
namespace {

RegistrationOptions Around(const std::string& central_frame) {
  RegistrationOptions options;
  options.central_frame = central_frame;
  options.thesis.num_frames = 3;
  options.thesis.skip = 10;
  options.thesis.neighborhood = 5;
  options.method = RegistrationMethod::kThesis;
  return options;
}

TEST(NarrowToReachTest, NamedCentralFrameBoundsTheVideo) {
  const VideoOptions narrowed = NarrowToReach({}, Around("100"));
  EXPECT_EQ(narrowed.first_frame, 55);
  EXPECT_EQ(narrowed.last_frame, 145);
}

TEST(NarrowToReachTest, NeverLeavesWhatTheUserAskedFor) {
  VideoOptions video;
  video.first_frame = 80;
  video.last_frame = 120;
  const VideoOptions narrowed = NarrowToReach(video, Around("100"));
  EXPECT_EQ(narrowed.first_frame, 80);
  EXPECT_EQ(narrowed.last_frame, 120);
  EXPECT_EQ(NarrowToReach({}, Around("10")).first_frame, 0);
}

TEST(NarrowToReachTest, KeepsTheFramesOfAStep) {
  VideoOptions video;
  video.first_frame = 1;
  video.frame_step = 7;
  const int first = NarrowToReach(video, Around("100")).first_frame;
  EXPECT_EQ((first - 1) % 7, 0);
  EXPECT_LE(first, 55);
  EXPECT_GT(first, 55 - 7);
}

TEST(NarrowToReachTest, WithoutAFrameNumberNothingChanges) {
  EXPECT_EQ(NarrowToReach({}, Around("")).last_frame, -1);
  EXPECT_EQ(NarrowToReach({}, Around("cam0_08.jpg")).last_frame, -1);
  RegistrationOptions unordered = Around("100");
  unordered.frame_order = FrameOrder::kUnordered;
  EXPECT_EQ(NarrowToReach({}, unordered).last_frame, -1);
  RegistrationOptions global = Around("100");
  global.method = RegistrationMethod::kGlobal;
  EXPECT_EQ(NarrowToReach({}, global).last_frame, -1);
}

TEST(RegistrationOptions, CentralFrameHasAShortName) {
  for (const char* name : {"--central_frame", "--Registration.central_frame"}) {
    RegistrationOptions options;
    ASSERT_TRUE(
        ParseOptions({"walker", "walks", "", {DescribeOptions(&options)}}, {name, "12"}, {}));
    EXPECT_EQ(options.central_frame, "12");
  }
}

}  // namespace
}  // namespace velamap
