#include "workflows/check/clip_frames.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(ClipFrames, AreSpreadOverTheWholeClip) {
  VideoOptions video;
  video.frame_step = 3;
  const auto step_of = [&](int num_frames) {
    return SpreadOverClip(video, num_frames, 10).frame_step;
  };
  EXPECT_EQ(step_of(0), 3);  // unknown
  EXPECT_EQ(step_of(10), 3);
  // With a step of 3, ten frames would end in the middle.
  EXPECT_EQ(step_of(19), 6);
  EXPECT_EQ(step_of(20), 6);
  EXPECT_EQ(step_of(21), 9);
}

}  // namespace
}  // namespace velamap
