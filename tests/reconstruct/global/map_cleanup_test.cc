#include "reconstruct/global/map_cleanup.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reconstruct/global/grown_map.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Cleanup, TakesNothingOutOfAGoodMap) {
  GrownMap grown(SailWithNoise(15, false, TestSeed()));
  VoteOnIds(&grown.global);
  DropWrongSizes(&grown.global);
  DropContradictions(grown.map.scene.layout, &grown.global);
  LeaveOutBlurredFrames(&grown.global);
  LimitFrames(&grown.global);
  DropUnsupported(&grown.global);
  EXPECT_THAT(grown.DroppedIds(), IsEmpty());
  EXPECT_THAT(grown.LeftOutFrames(), IsEmpty());
}

TEST(VoteOnIds, IdAtTwoPlacesWithEqualSupportGoes) {
  SyntheticScene scene = SailWithNoise(16, false, TestSeed());
  for (std::size_t i = 0; i < scene.frames.size(); i += 2) {
    // Marker 21 is printed with the id of 7, and either of the two is found.
    for (MarkerDetection& marker : scene.frames[i].markers) {
      if (marker.marker_id == 7) marker.marker_id = 900;
      if (marker.marker_id == 21) marker.marker_id = 7;
    }
    SortMarkers(&scene.frames[i]);
  }
  for (std::size_t i = 1; i < scene.frames.size(); i += 2) RemoveDetection(21, &scene.frames[i]);
  GrownMap grown(std::move(scene));
  VoteOnIds(&grown.global);
  EXPECT_THAT(grown.DroppedIds(), ElementsAre(7));
  EXPECT_THAT(grown.global.dropped_markers.begin()->second.reason, HasSubstr("two places"));
}

TEST(VoteOnIds, FewFalseReadingsAreOutvoted) {
  SyntheticScene scene = SailWithNoise(15, false, TestSeed());
  for (const int frame_idx : ReadSevenAtTwentyOne(3, &scene)) {
    RemoveDetection(21, &scene.frames[static_cast<std::size_t>(frame_idx)]);
  }
  GrownMap grown(std::move(scene));
  VoteOnIds(&grown.global);
  EXPECT_THAT(grown.DroppedIds(), IsEmpty());
}

TEST(VoteOnIds, PlaceOfABetterKnownMarkerIsNoSecondPlace) {
  SyntheticScene scene = SailWithNoise(18, false, TestSeed());
  // Marker 7 is seen in seven frames, three times at the place of 21, which all frames see.
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    if (i % 3 != 0 && i != 1) RemoveDetection(7, &scene.frames[i]);
  }
  ReadSevenAtTwentyOne(6, &scene);
  GrownMap grown(std::move(scene));
  ASSERT_EQ(grown.global.problem.Marker(grown.map.MarkerIdx(7)).observation_idxs.size(), 7u);
  ASSERT_EQ(grown.global.NumInliers(grown.map.MarkerIdx(7)), 4);
  VoteOnIds(&grown.global);
  EXPECT_THAT(grown.DroppedIds(), IsEmpty());
}

TEST(VoteOnIds, TurnedCornersAreNoSecondPlace) {
  SyntheticScene scene = SailWithNoise(15, false, TestSeed());
  int num_seen = 0, num_turned = 0;
  for (FrameDetections& frame : scene.frames) {
    MarkerDetection* marker = FindDetection(7, &frame);
    if (marker == nullptr) continue;
    ++num_seen;
    if (num_seen % 5 > 1) continue;  // two of five
    std::rotate(marker->corners_in_image_px.begin(), marker->corners_in_image_px.begin() + 1,
                marker->corners_in_image_px.end());
    ++num_turned;
  }
  ASSERT_GE(num_turned, 0.6 * (num_seen - num_turned));
  GrownMap grown(std::move(scene));
  VoteOnIds(&grown.global);
  EXPECT_THAT(grown.DroppedIds(), IsEmpty());
}

TEST(DropWrongSizes, DropsMarkersFarFromTheMedianSize) {
  GrownMap grown(SailWithNoise(12, false, TestSeed()));
  auto& places = grown.global.solution.shape_from_marker;
  places[3].front().scale = 1.5;
  places[8].front().scale = 0.5;
  places[9].front().scale = 1.15;
  grown.Update();
  DropWrongSizes(&grown.global);
  EXPECT_THAT(grown.DroppedIds(), ElementsAre(3, 8));
  EXPECT_THAT(grown.global.dropped_markers.at(3).reason, HasSubstr("1.50 times as long"));
  EXPECT_THAT(grown.global.dropped_markers.at(8).reason, HasSubstr("0.50 times as long"));
}

TEST(DropWrongSizes, CommonScaleOfAllMarkersChangesNothing) {
  GrownMap grown(SailWithNoise(12, false, TestSeed()));
  grown.global.solution.shape_from_marker[3].front().scale = 1.5;
  grown.global.solution = Transformed(ArbitrarySimilarity(7.0), grown.global.solution);
  grown.Update();
  DropWrongSizes(&grown.global);
  EXPECT_THAT(grown.DroppedIds(), ElementsAre(3));
  EXPECT_THAT(grown.global.dropped_markers.at(3).reason, HasSubstr("1.50 times as long"));
}

TEST(DropContradictions, DoesNotDependOnTheFrameAndTheScaleOfTheMap) {
  SyntheticScene scene = SailWithNoise(20, true, TestSeed());
  ASSERT_EQ(PlantFalseMarker(14, {0.7, -0.5, 0.3}, 3, &scene), 3);
  const Layout layout = scene.layout;
  for (const double scale : {1.0, 0.01, 30.0}) {
    GrownMap grown{SyntheticScene(scene)};
    auto& place =
        grown.global.solution.shape_from_marker[static_cast<std::size_t>(grown.map.MarkerIdx(14))];
    place.front().translation += Eigen::Vector3d(0.7, -0.5, 0.3);
    grown.global.solution = Transformed(ArbitrarySimilarity(scale), grown.global.solution);
    grown.Update();
    DropContradictions(layout, &grown.global);
    EXPECT_THAT(grown.DroppedIds(), ElementsAre(14));
    EXPECT_TRUE(grown.global.dropped_markers.begin()->second.is_false);
  }
}

TEST(DropContradictions, MisreadIdAtThePlaceOfAnotherMarkerGoes) {
  SyntheticScene scene = SailWithNoise(20, true, TestSeed());
  // Marker 7 is hidden, and in every fifth frame 21 is read as 7 with its corners turned.
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    FrameDetections& frame = scene.frames[i];
    const auto erase = [&frame](const MarkerDetection* marker) {
      if (marker != nullptr)
        frame.markers.erase(frame.markers.begin() + (marker - frame.markers.data()));
    };
    erase(FindDetection(7, &frame));
    MarkerDetection* marker = FindDetection(21, &frame);
    if (i % 5 != 0 || marker == nullptr) continue;
    marker->marker_id = 7;
    std::rotate(marker->corners_in_image_px.begin(), marker->corners_in_image_px.begin() + 1,
                marker->corners_in_image_px.end());
    SortMarkers(&frame);
  }
  GrownMap grown(std::move(scene));
  const std::size_t idx_7 = static_cast<std::size_t>(grown.map.MarkerIdx(7));
  const Sim3 place = grown.global.solution.Places(grown.map.MarkerIdx(21)).front();
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(-std::acos(0.0), Eigen::Vector3d::UnitZ()));
  grown.global.solution.shape_from_marker[idx_7] = {
      {place.scale, place.rotation * quarter, place.translation}};
  grown.Update();
  ASSERT_GE(grown.global.NumInliers(static_cast<int>(idx_7)), 3);
  DropContradictions(Layout(), &grown.global);
  EXPECT_THAT(grown.DroppedIds(), ElementsAre(7));
  EXPECT_THAT(grown.global.dropped_markers.begin()->second.reason,
              HasSubstr("a misread id: it is where marker 21 is"));
}

TEST(DropUnsupported, GoesOnUntilAllThatIsLeftHasEnough) {
  GrownMap grown(MakeScene(SceneKind::kSail, 12, false));
  GlobalRegistration& global = grown.global;
  grown.options.min_num_frames = 4;
  grown.options.min_num_inliers = 3;
  // A random third of the observations are inliers, so that one loss brings on another.
  std::mt19937 generator(TestSeed());
  for (char& is_inlier : global.solution.is_inlier) is_inlier = generator() % 3 == 0;
  DropUnsupported(&global);
  EXPECT_FALSE(grown.DroppedIds().empty());
  ASSERT_GT(global.solution.NumRegistered(), 4);
  for (std::size_t idx = 0; idx < global.problem.markers.size(); ++idx) {
    if (global.solution.shape_from_marker[idx].empty()) continue;
    EXPECT_GE(global.NumInliers(static_cast<int>(idx)), 4);
  }
  for (std::size_t idx = 0; idx < global.problem.frames.size(); ++idx) {
    if (!global.solution.cam_from_shape[idx]) continue;
    EXPECT_GE(global.NumInliersInFrame(static_cast<int>(idx)), 3);
  }
  const auto dropped_ids = grown.DroppedIds();
  const auto left_out = grown.LeftOutFrames();
  DropUnsupported(&global);
  EXPECT_EQ(grown.DroppedIds(), dropped_ids);
  EXPECT_EQ(grown.LeftOutFrames(), left_out);
}

TEST(DropUnsupported, OneLossBringsOnAnother) {
  GrownMap grown(MakeScene(SceneKind::kSail, 6, false));
  GlobalRegistration& global = grown.global;
  grown.options.min_num_frames = 2;
  grown.options.min_num_inliers = 2;
  const int marker_a = grown.map.MarkerIdx(grown.map.scene.frames[2].markers[0].marker_id);
  const int marker_b = grown.map.MarkerIdx(grown.map.scene.frames[2].markers[1].marker_id);
  // Frame 2 has these two markers left; one of them no other frame sees.
  for (const int idx : global.problem.Frame(2).observation_idxs) {
    const int marker_idx = global.problem.Observation(idx).marker_idx;
    global.solution.is_inlier[static_cast<std::size_t>(idx)] =
        marker_idx == marker_a || marker_idx == marker_b;
  }
  for (const int idx : global.problem.Marker(marker_a).observation_idxs) {
    if (global.problem.Observation(idx).frame_idx != 2) {
      global.solution.is_inlier[static_cast<std::size_t>(idx)] = 0;
    }
  }
  DropUnsupported(&global);
  EXPECT_THAT(grown.DroppedIds(), ElementsAre(global.problem.Marker(marker_a).marker_id));
  EXPECT_THAT(grown.LeftOutFrames(), ElementsAre(2));
  EXPECT_THAT(global.dropped_markers.at(marker_a).reason, HasSubstr("2 are needed"));
  EXPECT_THAT(global.left_out_of_image[2].reason, HasSubstr("1 of its"));
}

}  // namespace
}  // namespace velamap
