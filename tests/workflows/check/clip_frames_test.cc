#include "workflows/check/clip_frames.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

int StepOf(int num_frames, int max_num_frames) {
  VideoOptions video;
  video.frame_step = 1;
  return SpreadOverClip(video, num_frames, max_num_frames).frame_step;
}

TEST(SpreadOverClip, ChoosesNoMoreFramesThanAreWanted) {
  for (const int num_frames : {1, 39, 40, 41, 79, 150, 151, 1000}) {
    for (const int max_num_frames : {5, 10, 40, 60, 1000}) {
      const int step = StepOf(num_frames, max_num_frames);
      EXPECT_LE((num_frames - 1) / step + 1, max_num_frames) << num_frames;
      // One step less would be too many.
      if (step > 1) {
        EXPECT_GT((num_frames - 1) / (step - 1) + 1, max_num_frames) << num_frames;
      }
    }
  }
  EXPECT_EQ(StepOf(150, 40), 4);
  EXPECT_EQ(StepOf(150, 60), 3);
}

TEST(SpreadOverClip, TakesAllFramesOfAVideoOfUnknownLength) { EXPECT_EQ(StepOf(0, 40), 1); }

TEST(SpreadOverClip, KeepsTheStepThatTheUserGave) {
  VideoOptions video;
  video.frame_step = 3;
  EXPECT_EQ(SpreadOverClip(video, 50, 40).frame_step, 6);
}

}  // namespace
}  // namespace velamap
