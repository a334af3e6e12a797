#include "reconstruct/map/map_intersection.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reconstruct/map/map_refinement.h"
#include "tests/reconstruct/map/scene_map.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

// Places are asked for, poses are known.
MapSolution PosesOnly(MapSolution solution) {
  for (auto& places : solution.shape_from_marker) places.clear();
  std::fill(solution.is_inlier.begin(), solution.is_inlier.end(), 0);
  return solution;
}

double Error(const SceneMap& map, int marker_idx, const PlaceHypothesis& place) {
  return StepBetween(map.TruePlace(marker_idx), place.shape_from_marker).norm();
}

TEST(PlaceMarker, ExactCornersGiveTheExactPlace) {
  const SceneMap map = NoisySail(0.0, 1);
  const MapSolution poses = PosesOnly(map.TrueSolution());
  for (int marker_idx = 0; marker_idx < 30; ++marker_idx) {
    const MarkerPlacement placement = PlaceMarker(map.problem, poses, marker_idx, 1.0);
    ASSERT_THAT(placement.places, SizeIs(1)) << marker_idx;
    EXPECT_LT(Error(map, marker_idx, placement.places.front()), 1e-9);
    const auto& seen_idxs = map.problem.Marker(marker_idx).observation_idxs;
    EXPECT_EQ(placement.places.front().inlier_idxs, seen_idxs);
    EXPECT_EQ(placement.num_seen, static_cast<int>(seen_idxs.size()));
    EXPECT_THAT(placement.elsewhere_idxs, IsEmpty());
  }
}

TEST(PlaceMarker, ChoiceOfTheShapeFrameChangesNothing) {
  const SceneMap map = NoisySail(0.3, TestSeed());
  const MapSolution poses = PosesOnly(map.TrueSolution());
  const Sim3 new_from_shape = ArbitrarySimilarity(1.0);
  const MapSolution moved = Transformed(new_from_shape, poses);
  for (int marker_idx = 0; marker_idx < 30; marker_idx += 5) {
    MapSolution placed = poses;
    placed.shape_from_marker[static_cast<std::size_t>(marker_idx)] = {
        PlaceMarker(map.problem, poses, marker_idx, 1.0).places.front().shape_from_marker};
    const MapSolution expected = Transformed(new_from_shape, placed);
    const auto in_moved = PlaceMarker(map.problem, moved, marker_idx, 1.0).places;
    EXPECT_LT(
        StepBetween(expected.Places(marker_idx).front(), in_moved.front().shape_from_marker).norm(),
        1e-4);
  }
}

TEST(PlaceMarker, OrderOfFramesChangesNothing) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 15, false);
  AddNoise({0.3, 0.0, 0.1, 200, TestSeed()}, &scene);
  SyntheticScene reversed = scene;
  std::reverse(reversed.frames.begin(), reversed.frames.end());
  std::reverse(reversed.cam_from_world.begin(), reversed.cam_from_world.end());
  const SceneMap map(std::move(scene)), reversed_map(std::move(reversed));
  for (int marker_idx = 0; marker_idx < 30; ++marker_idx) {
    const auto places =
        PlaceMarker(map.problem, PosesOnly(map.TrueSolution()), marker_idx, 1.0).places;
    const auto reversed_places =
        PlaceMarker(reversed_map.problem, PosesOnly(reversed_map.TrueSolution()), marker_idx, 1.0)
            .places;
    EXPECT_EQ(places.front().inlier_idxs.size(), reversed_places.front().inlier_idxs.size());
    EXPECT_LT(
        StepBetween(places.front().shape_from_marker, reversed_places.front().shape_from_marker)
            .norm(),
        1e-4);
  }
}

// map_refinement_test.cc checks how good that is.
TEST(PlaceMarker, ThePlaceIsTheRefinedOne) {
  const SceneMap map = NoisySail(0.4, TestSeed());
  const MapSolution truth = map.TrueSolution();
  for (int marker_idx = 0; marker_idx < 30; ++marker_idx) {
    const auto places = PlaceMarker(map.problem, PosesOnly(truth), marker_idx, 1.0).places;
    EXPECT_EQ(places.front().inlier_idxs, map.problem.Marker(marker_idx).observation_idxs);
    const Sim3 refined = RefineMarkerPlace(map.problem, truth, places.front().inlier_idxs,
                                           map.TruePlace(marker_idx));
    EXPECT_LT(StepBetween(refined, places.front().shape_from_marker).norm(), 1e-4);
  }
}

TEST(PlaceMarker, WorksWhicheverPlanarSolutionComesFirst) {
  SceneMap map = NoisySail(0.2, TestSeed());
  for (MapObservation& observation : map.problem.observations) {
    std::reverse(observation.cam_from_marker.begin(), observation.cam_from_marker.end());
  }
  for (int marker_idx = 0; marker_idx < 30; ++marker_idx) {
    const auto places =
        PlaceMarker(map.problem, PosesOnly(map.TrueSolution()), marker_idx, 1.0).places;
    ASSERT_THAT(places, SizeIs(1)) << marker_idx;
    EXPECT_LT(Error(map, marker_idx, places.front()), 0.02);
  }
}

TEST(PlaceMarker, OneFrameGivesItsPlanarSolutions) {
  const SceneMap map = NoisySail(0.0, 1);
  MapSolution poses = EmptySolution(map.problem);
  poses.cam_from_shape[7] = map.scene.cam_from_world[7];
  const int marker_id = map.scene.frames[7].markers[4].marker_id;
  const int marker_idx = map.MarkerIdx(marker_id);
  const MarkerPlacement placement = PlaceMarker(map.problem, poses, marker_idx, 1.0);
  const MapObservation& observation = map.problem.Observation(map.ObservationIdx(7, marker_id));
  ASSERT_THAT(placement.places, SizeIs(observation.cam_from_marker.size()));
  EXPECT_EQ(placement.num_seen, 1);
  EXPECT_LT(Error(map, marker_idx, placement.places.front()), 1e-6);
  for (const PlaceHypothesis& place : placement.places) {
    EXPECT_EQ(place.inlier_idxs, std::vector<int>{map.ObservationIdx(7, marker_id)});
  }
}

TEST(PlaceMarker, MarkerThatNoRegisteredFrameSeesHasNoPlace) {
  const SceneMap map = NoisySail(0.0, 1);
  const MarkerPlacement placement = PlaceMarker(map.problem, EmptySolution(map.problem), 3, 1.0);
  EXPECT_THAT(placement.places, IsEmpty());
  EXPECT_EQ(placement.num_seen, 0);
}

TEST(PlaceMarker, TwoFramesThatDisagreeGiveNoPlace) {
  SceneMap map = NoisySail(0.0, 1);
  MapSolution poses = EmptySolution(map.problem);
  for (const std::size_t idx : {std::size_t{2}, std::size_t{12}}) {
    poses.cam_from_shape[idx] = map.scene.cam_from_world[idx];
  }
  // One of the frames stands elsewhere: its rays miss those of the other.
  poses.cam_from_shape[12] =
      *poses.cam_from_shape[12] * Rigid3{Eigen::Quaterniond::Identity(), {0, 0, 0.5}};
  for (const MarkerDetection& marker : map.scene.frames[2].markers) {
    if (map.ObservationIdx(12, marker.marker_id) < 0) continue;
    const MarkerPlacement placement =
        PlaceMarker(map.problem, poses, map.MarkerIdx(marker.marker_id), 1.0);
    EXPECT_THAT(placement.places, IsEmpty()) << marker.marker_id;
    EXPECT_EQ(placement.num_seen, 2);
  }
}

TEST(PlaceMarker, FalseIdInAThirdOfTheFramesIsFoundElsewhere) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 15, false);
  const std::vector<int> false_frames = ReadSevenAtTwentyOne(3, &scene);
  ASSERT_GE(false_frames.size(), 4u);
  const SceneMap map(std::move(scene));
  const MarkerPlacement placement =
      PlaceMarker(map.problem, PosesOnly(map.TrueSolution()), map.MarkerIdx(7), 1.0);
  ASSERT_THAT(placement.places, SizeIs(1));
  EXPECT_LT(Error(map, map.MarkerIdx(7), placement.places.front()), 1e-9);
  std::vector<int> false_idxs;
  for (const int frame_idx : false_frames) false_idxs.push_back(map.ObservationIdx(frame_idx, 7));
  EXPECT_EQ(placement.elsewhere_idxs, false_idxs);
}

TEST(PlaceMarker, OneIdAtTwoPlacesHasAPlaceAndARestElsewhere) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 16, false);
  const std::vector<int> false_frames = ReadSevenAtTwentyOne(2, &scene);
  const SceneMap map(std::move(scene));
  const int marker_idx = map.MarkerIdx(7);
  const MarkerPlacement placement =
      PlaceMarker(map.problem, PosesOnly(map.TrueSolution()), marker_idx, 1.0);
  ASSERT_FALSE(placement.places.empty());
  const auto& here = placement.places.front().inlier_idxs;
  // The two groups are all observations, and none is in both.
  std::vector<int> all = here;
  all.insert(all.end(), placement.elsewhere_idxs.begin(), placement.elsewhere_idxs.end());
  std::sort(all.begin(), all.end());
  EXPECT_EQ(all, map.problem.Marker(marker_idx).observation_idxs);
  const bool is_at_seven = Error(map, marker_idx, placement.places.front()) < 1e-9;
  EXPECT_EQ((is_at_seven ? placement.elsewhere_idxs : here).size(), false_frames.size());
}

TEST(PlaceMarker, MarkerOfTwiceTheNominalSizeIsPlacedAsLargeAsItIs) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 15, false);
  scene.layout.marker_lengths_m[8] = 0.5 * scene.layout.marker_length_m;
  const SceneMap map(std::move(scene));
  const int marker_idx = map.MarkerIdx(8);
  const auto places =
      PlaceMarker(map.problem, PosesOnly(map.TrueSolution()), marker_idx, 1.0).places;
  ASSERT_FALSE(places.empty());
  EXPECT_NEAR(places.front().shape_from_marker.scale, 2.0, 0.04);
  EXPECT_EQ(places.front().inlier_idxs.size(),
            map.problem.Marker(marker_idx).observation_idxs.size());
}

}  // namespace
}  // namespace velamap
