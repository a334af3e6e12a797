#include "reconstruct/global/map_cleanup.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reconstruct/global/scene_map.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// The true map of a scene as the state that cleanup works on. The state refers to the options and
// to the map, so they live together.
struct GrownMap {
  RegistrationOptions options;
  SceneMap map;
  GlobalRegistration global{options, {}, {}, false, -1, {}, {}, {}, {}, {}, {}};

  explicit GrownMap(SyntheticScene scene) : map(std::move(scene)) {
    for (const DatabaseImage& image : map.images) global.images.push_back(&image);
    global.image_idx_of_frame.resize(map.images.size());
    std::iota(global.image_idx_of_frame.begin(), global.image_idx_of_frame.end(), 0);
    global.reason_of_image.resize(map.images.size());
    global.problem = map.problem;
    global.solution = map.TrueSolution();
    Update();
  }
  GrownMap(const GrownMap&) = delete;

  // Fits and noise of the solution as it stands.
  void Update() {
    MarkFits(global.problem, 1.0, &global.solution);
    global.noise = EstimateNoise(global.problem, global.solution);
  }

  std::vector<int> DroppedIds() const {
    std::vector<int> ids;
    for (const auto& [marker_idx, dropped] : global.dropped_markers) {
      EXPECT_EQ(dropped.marker_id, global.problem.Marker(marker_idx).marker_id);
      EXPECT_FALSE(dropped.reason.empty());
      EXPECT_TRUE(global.solution.shape_from_marker[static_cast<std::size_t>(marker_idx)].empty());
      EXPECT_EQ(global.NumFits(marker_idx), 0);
      ids.push_back(dropped.marker_id);
    }
    return ids;
  }

  std::vector<int> LeftOutFrames() const {
    std::vector<int> frame_idxs;
    for (std::size_t idx = 0; idx < global.problem.frames.size(); ++idx) {
      const bool is_registered = global.solution.cam_from_shape[idx].has_value();
      EXPECT_EQ(global.reason_of_image[idx].empty(), is_registered) << idx;
      if (is_registered) continue;
      EXPECT_EQ(global.NumFitsInFrame(static_cast<int>(idx)), 0);
      frame_idxs.push_back(static_cast<int>(idx));
    }
    return frame_idxs;
  }
};

SyntheticScene SailWithNoise(int num_frames, bool video, std::uint32_t seed) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, num_frames, video);
  AddNoise({0.2, 0.0, 0.0, 0, seed}, &scene);
  return scene;
}

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

// In every `step`-th frame the id of marker 7 is read where marker 21 stands; the detection of 21
// stays in the frame if `keep`.
void ReadSevenAtTwentyOne(std::size_t step, bool keep, SyntheticScene* scene) {
  for (std::size_t i = 0; i < scene->frames.size(); i += step) {
    FrameDetections& frame = scene->frames[i];
    MarkerDetection* seven = FindDetection(7, &frame);
    MarkerDetection* twenty_one = FindDetection(21, &frame);
    if (seven == nullptr || twenty_one == nullptr) continue;
    seven->corners_in_image_px = twenty_one->corners_in_image_px;
    if (!keep) frame.markers.erase(frame.markers.begin() + (twenty_one - frame.markers.data()));
  }
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
  for (std::size_t i = 1; i < scene.frames.size(); i += 2) {
    auto& markers = scene.frames[i].markers;
    markers.erase(std::remove_if(markers.begin(), markers.end(),
                                 [](const auto& m) { return m.marker_id == 21; }),
                  markers.end());
  }
  GrownMap grown(std::move(scene));
  VoteOnIds(&grown.global);
  EXPECT_THAT(grown.DroppedIds(), ElementsAre(7));
  EXPECT_THAT(grown.global.dropped_markers.begin()->second.reason, HasSubstr("two places"));
}

TEST(VoteOnIds, FewFalseReadingsAreOutvoted) {
  SyntheticScene scene = SailWithNoise(15, false, TestSeed());
  ReadSevenAtTwentyOne(3, false, &scene);
  GrownMap grown(std::move(scene));
  VoteOnIds(&grown.global);
  EXPECT_THAT(grown.DroppedIds(), IsEmpty());
}

TEST(VoteOnIds, PlaceOfABetterKnownMarkerIsNoSecondPlace) {
  SyntheticScene scene = SailWithNoise(18, false, TestSeed());
  // Marker 7 is seen in seven frames, three times at the place of 21, which all frames see.
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    auto& markers = scene.frames[i].markers;
    if (i % 3 == 0 || i == 1) continue;
    markers.erase(std::remove_if(markers.begin(), markers.end(),
                                 [](const auto& m) { return m.marker_id == 7; }),
                  markers.end());
  }
  ReadSevenAtTwentyOne(6, true, &scene);
  GrownMap grown(std::move(scene));
  ASSERT_EQ(grown.global.problem.Marker(grown.map.MarkerIdx(7)).observation_idxs.size(), 7u);
  ASSERT_EQ(grown.global.NumFits(grown.map.MarkerIdx(7)), 4);
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

TEST(LeaveOutBlurredFrames, LeavesOutTheBlurredAlone) {
  SyntheticScene scene = SailWithNoise(26, false, TestSeed());
  BlurFrames(1.2, TestSeed() + 1, &scene);
  GrownMap grown(std::move(scene));
  LeaveOutBlurredFrames(&grown.global);
  EXPECT_THAT(grown.LeftOutFrames(), ElementsAre(5, 15, 25));
  EXPECT_THAT(grown.global.reason_of_image[15], HasSubstr("blurred"));
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
    if (i == 5 || i == 10 || i == 15) continue;
    auto& markers = scene.frames[i].markers;
    markers.erase(std::remove_if(markers.begin(), markers.end(),
                                 [](const auto& m) { return m.marker_id == 7; }),
                  markers.end());
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
    EXPECT_TRUE(grown.global.solution.cam_from_shape[static_cast<std::size_t>(central_idx)]);
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
  const Sim3 place =
      grown.global.solution.shape_from_marker[static_cast<std::size_t>(grown.map.MarkerIdx(21))]
          .front();
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(-std::acos(0.0), Eigen::Vector3d::UnitZ()));
  grown.global.solution.shape_from_marker[idx_7] = {
      {place.scale, place.rotation * quarter, place.translation}};
  grown.Update();
  ASSERT_GE(grown.global.NumFits(static_cast<int>(idx_7)), 3);
  DropContradictions(Layout(), &grown.global);
  EXPECT_THAT(grown.DroppedIds(), ElementsAre(7));
  EXPECT_THAT(grown.global.dropped_markers.begin()->second.reason,
              HasSubstr("a misread id: it stands where marker 21 stands"));
}

TEST(DropUnsupported, GoesOnUntilAllThatIsLeftHasEnough) {
  GrownMap grown(MakeScene(SceneKind::kSail, 12, false));
  GlobalRegistration& global = grown.global;
  grown.options.min_num_frames = 4;
  grown.options.min_num_inliers = 3;
  // A random third of the observations fits, so that one loss brings on another.
  std::mt19937 generator(TestSeed());
  for (char& fits : global.solution.fits) fits = generator() % 3 == 0;
  DropUnsupported(&global);
  EXPECT_FALSE(grown.DroppedIds().empty());
  ASSERT_GT(global.solution.NumRegistered(), 4);
  for (std::size_t idx = 0; idx < global.problem.markers.size(); ++idx) {
    if (global.solution.shape_from_marker[idx].empty()) continue;
    EXPECT_GE(global.NumFits(static_cast<int>(idx)), 4);
  }
  for (std::size_t idx = 0; idx < global.problem.frames.size(); ++idx) {
    if (!global.solution.cam_from_shape[idx]) continue;
    EXPECT_GE(global.NumFitsInFrame(static_cast<int>(idx)), 3);
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
    global.solution.fits[static_cast<std::size_t>(idx)] =
        marker_idx == marker_a || marker_idx == marker_b;
  }
  for (const int idx : global.problem.Marker(marker_a).observation_idxs) {
    if (global.problem.Observation(idx).frame_idx != 2) {
      global.solution.fits[static_cast<std::size_t>(idx)] = 0;
    }
  }
  DropUnsupported(&global);
  EXPECT_THAT(grown.DroppedIds(), ElementsAre(global.problem.Marker(marker_a).marker_id));
  EXPECT_THAT(grown.LeftOutFrames(), ElementsAre(2));
  EXPECT_THAT(global.dropped_markers.at(marker_a).reason, HasSubstr("2 are needed"));
  EXPECT_THAT(global.reason_of_image[2], HasSubstr("1 of its"));
}

}  // namespace
}  // namespace velamap
