// The frames that cleanup leaves out; map_cleanup_test.cc has the markers.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reconstruct/global/global_registration_fixture.h"
#include "tests/reconstruct/global/grown_map.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(LeaveOutBlurredFrames, LeavesOutTheBlurredAlone) {
  SyntheticScene scene = SailWithNoise(26, false, TestSeed());
  BlurFrames(1.2, TestSeed() + 1, &scene);
  GrownMap grown(std::move(scene));
  LeaveOutBlurredFrames(&grown.global);
  EXPECT_THAT(grown.LeftOutFrames(), ElementsAre(5, 15, 25));
  EXPECT_THAT(grown.global.left_out_of_image[15].reason, HasSubstr("blurred"));
}

TEST(LeaveOutBlurredFrames, BlurContradictsNothing) {
  SyntheticScene blurred = SailWithNoise(26, false, TestSeed());
  BlurFrames(1.2, TestSeed() + 1, &blurred);
  GrownMap blurred_map(std::move(blurred));
  LeaveOutBlurredFrames(&blurred_map.global);
  EXPECT_THAT(blurred_map.LeftOutFrames(), ElementsAre(5, 15, 25));
  EXPECT_THAT(blurred_map.global.num_contradicting_of_frame, IsEmpty());
}

// The frames 5, 15 and 25 are of a camera with a longer lens.
SyntheticScene WithThreeFramesOfAnotherLens(SyntheticScene scene, double zoom) {
  SyntheticScene zoomed = scene;
  ZoomFrom(0, zoom, &zoomed);
  for (const std::size_t i : {5, 15, 25}) scene.frames[i] = zoomed.frames[i];
  return scene;
}

TEST(LeaveOutBlurredFrames, SharpFramesThatDoNotFitContradictTheMap) {
  GrownMap grown(WithThreeFramesOfAnotherLens(SailWithNoise(26, false, TestSeed()), 1.004));
  LeaveOutBlurredFrames(&grown.global);
  EXPECT_THAT(grown.LeftOutFrames(), ElementsAre(5, 15, 25));
  for (const int idx : {5, 15, 25}) {
    EXPECT_THAT(grown.global.left_out_of_image[static_cast<std::size_t>(idx)].reason,
                HasSubstr("sharp, but of another camera"));
    EXPECT_GE(grown.global.num_contradicting_of_frame[idx], 8) << idx;
  }
  EXPECT_EQ(grown.global.num_contradicting_of_frame.size(), 3u);
}

TEST(CameraDoubt, AThirdOfBlurredFramesIsNoReason) {
  SyntheticScene scene = SailWithNoise(21, false, TestSeed());
  SyntheticScene blurred = scene;
  AddNoise({1.5, 0.0, 0.0, 0, TestSeed() + 1}, &blurred);
  for (std::size_t i = 1; i < scene.frames.size(); i += 3) scene.frames[i] = blurred.frames[i];
  EXPECT_THAT(CameraDoubt(Register(scene)), IsEmpty());
}

TEST(LeaveOutBlurredFrames, FrameThatTheUserNamedStays) {
  SyntheticScene scene = SailWithNoise(26, false, TestSeed());
  BlurFrames(1.2, TestSeed() + 1, &scene);
  GrownMap grown(std::move(scene));
  grown.global.central_image_idx = 15;
  LeaveOutBlurredFrames(&grown.global);
  EXPECT_THAT(grown.LeftOutFrames(), ElementsAre(5, 25));
}

TEST(LeaveOutBlurredFrames, FrameThatAMarkerNeedsStays) {
  SyntheticScene scene = SailWithNoise(16, false, TestSeed());
  BlurFrames(1.2, TestSeed() + 1, &scene);
  // Marker 7 is seen by the blurred frames and by one more.
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    if (i != 5 && i != 10 && i != 15) RemoveDetection(7, &scene.frames[i]);
  }
  ASSERT_NE(FindDetection(7, &scene.frames[5]), nullptr);
  ASSERT_EQ(FindDetection(7, &scene.frames[15]) == nullptr, false);
  GrownMap grown(std::move(scene));
  LeaveOutBlurredFrames(&grown.global);
  EXPECT_THAT(grown.LeftOutFrames(), IsEmpty());
}

TEST(LimitFrames, KeepsAsManyFramesOfAVideoAsTheOptionSays) {
  for (const int max_num_frames : {4, 10}) {
    GrownMap grown(SailWithNoise(24, true, TestSeed()));
    grown.global.is_video = true;
    grown.options.global.max_num_frames = max_num_frames;
    LimitFrames(&grown.global);
    EXPECT_EQ(grown.global.solution.NumRegistered(), max_num_frames);
    EXPECT_EQ(static_cast<int>(grown.LeftOutFrames().size()), 24 - max_num_frames);
  }
}

TEST(LimitFrames, FrameThatTheUserNamedStays) {
  for (const int central_idx : {0, 11, 23}) {
    GrownMap grown(SailWithNoise(24, true, TestSeed()));
    grown.global.is_video = true;
    grown.global.central_image_idx = central_idx;
    grown.options.global.max_num_frames = 4;
    LimitFrames(&grown.global);
    EXPECT_TRUE(grown.global.solution.Pose(central_idx));
  }
}

TEST(LimitFrames, TakesFramesWithSharpCornersFirst) {
  GrownMap grown(SailWithNoise(24, true, TestSeed()));
  grown.global.is_video = true;
  grown.global.central_image_idx = 0;
  for (MapObservation& observation : grown.global.problem.observations) {
    if (observation.frame_idx % 2 == 1) observation.sigma_px *= 5;
  }
  grown.options.global.max_num_frames = 8;
  LimitFrames(&grown.global);
  for (std::size_t idx = 1; idx < 24; idx += 2) {
    EXPECT_FALSE(grown.global.solution.cam_from_shape[idx]) << idx;
  }
}

TEST(LimitFrames, PhotographsAllStay) {
  GrownMap grown(SailWithNoise(12, false, TestSeed()));
  grown.options.global.max_num_frames = 4;
  LimitFrames(&grown.global);
  EXPECT_THAT(grown.LeftOutFrames(), IsEmpty());
}

TEST(LimitFrames, ChoosesTheSameFramesInAnyShapeFrame) {
  GrownMap grown(SailWithNoise(24, true, TestSeed())), moved(SailWithNoise(24, true, TestSeed()));
  moved.global.solution = Transformed(ArbitrarySimilarity(1.0), moved.global.solution);
  for (GrownMap* map : {&grown, &moved}) {
    map->global.is_video = true;
    map->options.global.max_num_frames = 6;
    LimitFrames(&map->global);
  }
  EXPECT_EQ(grown.LeftOutFrames(), moved.LeftOutFrames());
}

}  // namespace
}  // namespace velamap
