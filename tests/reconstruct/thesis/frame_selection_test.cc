#include "reconstruct/thesis/frame_selection.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/reconstruct/registration_fixture.h"

namespace velamap {
namespace {

SyntheticScene Clip(int num_frames) {
  SyntheticSceneOptions options;
  options.num_frames = num_frames;
  return MakeSyntheticScene(options);
}

std::vector<SelectedFrame> Search(const std::vector<FrameShape>& frames, int central_idx,
                                  const ThesisRegistrationOptions& thesis, const Layout& layout) {
  RegistrationOptions options;
  options.thesis = thesis;
  return SearchFrames(frames, central_idx, layout, options);
}

TEST(FrameSelection, SharedMarkersAreCounted) {
  const auto make = [](const std::vector<int>& ids) {
    FrameShape frame;
    for (const int id : ids) frame.markers.push_back({id, {}, {}, 0.0});
    return frame;
  };
  EXPECT_EQ(NumSharedMarkers(make({1, 3, 5, 9}), make({0, 3, 4, 9, 10})), 2);
  EXPECT_EQ(NumSharedMarkers(make({}), make({1})), 0);
}

TEST(FrameSelection, CentralFrameIsTheOneWhoseMarkersRecurMost) {
  SyntheticScene scene = Clip(5);
  auto frames = FrameShapes(scene);
  frames[0].markers.resize(4);
  frames[3].markers.resize(6);
  frames[4].markers.resize(2);
  const std::size_t richer = frames[1].markers.size() >= frames[2].markers.size() ? 1 : 2;
  EXPECT_EQ(ChooseCentralFrame(frames).frame_idx, static_cast<int>(richer));
}

TEST(FrameSelection, SearchVisitsWindowsOfTheThesis) {
  const SyntheticScene scene = Clip(61);
  const auto frames = FrameShapes(scene);
  const ThesisRegistrationOptions search{2, 10, 3};
  const auto selected = Search(frames, 30, search, scene.layout);
  ASSERT_EQ(selected.size(), 4u);
  EXPECT_NEAR(selected[1].frame_idx, 20, 3);
  EXPECT_NEAR(selected[0].frame_idx, selected[1].frame_idx - 10, 3);
  EXPECT_NEAR(selected[2].frame_idx, 40, 3);
  EXPECT_NEAR(selected[3].frame_idx, selected[2].frame_idx + 10, 3);
}

TEST(FrameSelection, SearchTakesTheFrameWithMostInliers) {
  const SyntheticScene scene = Clip(31);
  auto frames = FrameShapes(scene);
  for (std::size_t idx = 16; idx < 31; ++idx) {
    if (idx != 27) frames[idx].markers.resize(8);
  }
  const auto selected = Search(frames, 15, {1, 10, 5}, scene.layout);
  ASSERT_EQ(selected.size(), 2u);
  EXPECT_EQ(selected[1].frame_idx, 27);
}

TEST(FrameSelection, EmptyWindowIsPassedOver) {
  const SyntheticScene scene = Clip(41);
  auto frames = FrameShapes(scene);
  frames.erase(frames.begin() + 22, frames.begin() + 35);
  const auto selected = Search(frames, 15, {3, 5, 2}, scene.layout);
  ASSERT_FALSE(selected.empty());
  EXPECT_GE(*frames[static_cast<std::size_t>(selected.back().frame_idx)].frame_number, 35);
}

TEST(FrameSelection, SearchStaysWithinReach) {
  const SyntheticScene scene = Clip(121);
  const auto frames = FrameShapes(scene);
  const ThesisRegistrationOptions search{3, 10, 5};
  const auto [first, last] = ReachableFrames(60, search);
  EXPECT_EQ(first, 15);
  EXPECT_EQ(last, 105);
  for (const SelectedFrame& selected : Search(frames, 60, search, scene.layout)) {
    EXPECT_GE(selected.frame_idx, first);
    EXPECT_LE(selected.frame_idx, last);
  }
}

// With an overflow the reach becomes too short, or the loops run over billions of steps.
TEST(FrameSelection, HugeOptionsReachAllFrames) {
  constexpr int kHuge = std::numeric_limits<int>::max();
  const SyntheticScene scene = Clip(5);
  const auto frames = FrameShapes(scene);
  for (const ThesisRegistrationOptions& search :
       {ThesisRegistrationOptions{kHuge, kHuge, kHuge}, ThesisRegistrationOptions{kHuge, 1, kHuge},
        ThesisRegistrationOptions{kHuge, 1, 1}, ThesisRegistrationOptions{100000, 100000, 5}}) {
    EXPECT_EQ(ReachableFrames(60, search), std::make_pair(0, kHuge));
    // All frames are equally good.
    EXPECT_EQ(ChooseCentralVideoFrame(frames, search).frame_idx, 0);
    EXPECT_LE(Search(frames, 2, search, scene.layout).size(), 4u);
  }
  EXPECT_EQ(Search(frames, 2, {kHuge, 1, 0}, scene.layout).size(), 4u);
  EXPECT_EQ(FitToVideo({kHuge, 10, 5}, 80).skip, 1);
}

TEST(FrameSelection, ShortVideoShrinksTheSkip) {
  const ThesisRegistrationOptions thesis;
  EXPECT_EQ(FitToVideo(thesis, 1000).skip, 10);
  EXPECT_EQ(FitToVideo(thesis, 1000).neighborhood, 5);
  EXPECT_EQ(FitToVideo(thesis, 80).skip, 4);
  EXPECT_EQ(FitToVideo(thesis, 80).neighborhood, 2);
  EXPECT_EQ(FitToVideo(thesis, 39).skip, 2);
  EXPECT_EQ(FitToVideo(thesis, 5).skip, 1);
  EXPECT_EQ(FitToVideo(thesis, 5).neighborhood, 0);
}

}  // namespace
}  // namespace velamap
