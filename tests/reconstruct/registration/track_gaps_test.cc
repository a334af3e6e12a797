#include "reconstruct/registration/track_gaps.h"

#include <cmath>

#include <gtest/gtest.h>

namespace velamap {
namespace {

constexpr int kNumFrames = 6, kNumMarkers = 5, kDrifting = 3;

// Where the shake of the camera and, for one marker, a motion of its own take a marker.
Eigen::Vector2d PlaceAt(int frame, int marker_id) {
  const Eigen::Vector2d start_px(150.0 * (marker_id % 3), 120.0 * (marker_id / 3));
  const double shake = std::sin(2.0 * frame);
  const Eigen::Vector2d own_px =
      marker_id == kDrifting ? Eigen::Vector2d(0.5, -0.2) * frame : Eigen::Vector2d(0.0, 0.0);
  return start_px + Eigen::Vector2d(20, -8) * shake + own_px;
}

std::vector<TimedPlaces> ShakyTracks() {
  std::vector<TimedPlaces> frames;
  for (int i = 0; i < kNumFrames; ++i) {
    TimedPlaces frame{i / 30.0, 40.0, i + 1 < kNumFrames, {}};
    for (int id = 0; id < kNumMarkers; ++id) frame.places.emplace(id, PlaceAt(i, id));
    frames.push_back(std::move(frame));
  }
  return frames;
}

void Remove(int marker_id, std::initializer_list<std::size_t> frame_idxs,
            std::vector<TimedPlaces>* frames) {
  for (const std::size_t i : frame_idxs) (*frames)[i].places.erase(marker_id);
}

TEST(FillGaps, AMarkerThatFramesLackShakesWithTheOthers) {
  std::vector<TimedPlaces> frames = ShakyTracks();
  Remove(1, {2}, &frames);
  Remove(0, {3, 4}, &frames);
  FillGaps(&frames);
  constexpr double kDrift_px = 0.6;  // of one of the others, from frame to frame
  EXPECT_LT((frames[2].places.at(1) - PlaceAt(2, 1)).norm(), kDrift_px);
  EXPECT_LT((frames[3].places.at(0) - PlaceAt(3, 0)).norm(), kDrift_px);
  EXPECT_LT((frames[4].places.at(0) - PlaceAt(4, 0)).norm(), kDrift_px);
}

TEST(FillGaps, ItsOwnMotionIsSteady) {
  std::vector<TimedPlaces> frames = ShakyTracks();
  Remove(kDrifting, {1, 2, 3}, &frames);
  FillGaps(&frames);
  for (int i = 1; i <= 3; ++i) {
    EXPECT_LT(
        (frames[static_cast<std::size_t>(i)].places.at(kDrifting) - PlaceAt(i, kDrifting)).norm(),
        1e-9);
  }
}

TEST(FillGaps, WhereNothingShowsTheMotionTheyStay) {
  std::vector<TimedPlaces> frames = ShakyTracks();
  Remove(0, {0, 2, 5}, &frames);
  frames[2].is_near_next = false;
  FillGaps(&frames);
  for (const std::size_t i : {0, 2, 5}) EXPECT_EQ(frames[i].places.count(0), 0u) << i;

  frames = ShakyTracks();
  for (const int id : {1, 2}) Remove(id, {0, 1, 2, 3, 4, 5}, &frames);
  Remove(0, {2}, &frames);  // two others are left
  FillGaps(&frames);
  EXPECT_EQ(frames[2].places.count(0), 0u);
}

}  // namespace
}  // namespace velamap
