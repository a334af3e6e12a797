#include "reconstruct/map/map_growth.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "reconstruct/map/map_adjustment.h"
#include "tests/reconstruct/map/scene_map.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

// Two frames of the truth, nothing placed: in the world frame, so that errors need no alignment.
MapSolution TwoTrueFrames(const SceneMap& map, std::size_t a, std::size_t b) {
  MapSolution solution = EmptySolution(map.problem);
  solution.cam_from_shape[a] = map.scene.cam_from_world[a];
  solution.cam_from_shape[b] = map.scene.cam_from_world[b];
  return solution;
}

int NumPlaced(const MapSolution& solution) {
  return static_cast<int>(std::count_if(solution.shape_from_marker.begin(),
                                        solution.shape_from_marker.end(),
                                        [](const auto& places) { return !places.empty(); }));
}

class GrowExactMap : public testing::TestWithParam<SceneKind> {};

TEST_P(GrowExactMap, RegistersAllFramesWhereTheyAre) {
  const SceneMap map(MakeScene(GetParam(), 24, false));
  MapSolution solution = TwoTrueFrames(map, 10, 14);
  GrowMap(map.problem, AllFrames(map.problem), {2, 0, true, TestSeed()}, &solution);
  EXPECT_EQ(solution.NumRegistered(), 24);
  EXPECT_EQ(NumPlaced(solution), static_cast<int>(map.problem.markers.size()));
  EXPECT_EQ(std::count(solution.is_inlier.begin(), solution.is_inlier.end(), 1),
            static_cast<std::ptrdiff_t>(map.problem.observations.size()));
  // The gauge of the adjustment is the first frame, whose pose has been resected: compare places
  // relative to it.
  const Rigid3 shape_from_world =
      Inverse(*solution.cam_from_shape[0]) * map.scene.cam_from_world[0];
  const MapSolution truth = Transformed(
      {1.0, shape_from_world.rotation, shape_from_world.translation}, map.TrueSolution());
  EXPECT_LT(MaxCornerDistance(map.problem, solution, truth), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Kinds, GrowExactMap,
                         testing::Values(SceneKind::kSail, SceneKind::kPlane, SceneKind::kCube));

TEST(GrowMap, OrderOfFramesChangesNothing) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 20, false);
  AddNoise({0.3, 0.1, 0.05, 200, TestSeed()}, &scene);
  const SceneMap map(std::move(scene));
  std::vector<int> frame_idxs = AllFrames(map.problem);
  const auto grown = [&] {
    MapSolution solution = TwoTrueFrames(map, 6, 12);
    GrowMap(map.problem, frame_idxs, {2, 0, true, TestSeed()}, &solution);
    AdjustMap(map.problem, {50, 1e-8}, &solution);
    return solution;
  };
  const MapSolution in_order = grown();
  std::shuffle(frame_idxs.begin(), frame_idxs.end(), std::mt19937(TestSeed()));
  const MapSolution shuffled = grown();
  EXPECT_EQ(in_order.NumRegistered(), 20);
  EXPECT_EQ(in_order.is_inlier, shuffled.is_inlier);
  const Rigid3 shuffled_from_other =
      Inverse(*shuffled.cam_from_shape[0]) * *in_order.cam_from_shape[0];
  EXPECT_LT(MaxCornerDistance(
                map.problem,
                Transformed({1.0, shuffled_from_other.rotation, shuffled_from_other.translation},
                            in_order),
                shuffled),
            1e-3);
}

TEST(GrowMap, StopsAtTheLargestNumberOfFrames) {
  const SceneMap map(MakeScene(SceneKind::kSail, 20, false));
  for (const int max_num_frames : {2, 7, 20}) {
    MapSolution solution = TwoTrueFrames(map, 6, 12);
    GrowMap(map.problem, AllFrames(map.problem), {2, max_num_frames, true, TestSeed()}, &solution);
    EXPECT_EQ(solution.NumRegistered(), max_num_frames);
  }
}

TEST(GrowMap, RegistersOnlyTheFramesThatAreAskedFor) {
  const SceneMap map(MakeScene(SceneKind::kSail, 12, false));
  MapSolution solution = TwoTrueFrames(map, 3, 8);
  GrowMap(map.problem, {1, 5, 10}, {2, 0, true, TestSeed()}, &solution);
  for (const int frame_idx : AllFrames(map.problem)) {
    const bool is_expected = std::set<int>{1, 3, 5, 8, 10}.count(frame_idx) > 0;
    EXPECT_EQ(solution.Pose(frame_idx).has_value(), is_expected);
  }
}

TEST(GrowMap, WithoutAdjustmentARegisteredFrameStays) {
  const SceneMap map = NoisySail(0.3, TestSeed());
  MapSolution solution = TwoTrueFrames(map, 3, 11);
  GrowMap(map.problem, AllFrames(map.problem), {2, 0, false, TestSeed()}, &solution);
  EXPECT_EQ(solution.NumRegistered(), 15);
  for (const std::size_t idx : {std::size_t{3}, std::size_t{11}}) {
    EXPECT_EQ(StepBetween(map.scene.cam_from_world[idx], *solution.cam_from_shape[idx]).norm(), 0);
  }
}

TEST(GrowMap, FramesThatDoNotBelongStayOut) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 12, false);
  // Frame 2 reads every id wrong, frame 6 sees another board, frame 9 sees one marker of this one.
  std::vector<int> ids;
  for (const MarkerDetection& marker : scene.frames[2].markers) ids.push_back(marker.marker_id);
  std::shuffle(ids.begin(), ids.end(), std::mt19937(TestSeed()));
  for (std::size_t i = 0; i < ids.size(); ++i) scene.frames[2].markers[i].marker_id = ids[i];
  SortMarkers(&scene.frames[2]);
  for (MarkerDetection& marker : scene.frames[6].markers) marker.marker_id += 500;
  scene.frames[9].markers.resize(1);
  const SceneMap map(std::move(scene));
  MapSolution solution = TwoTrueFrames(map, 4, 10);
  GrowMap(map.problem, AllFrames(map.problem), {2, 0, true, TestSeed()}, &solution);
  EXPECT_EQ(solution.NumRegistered(), 9);
  for (const std::size_t idx : {std::size_t{2}, std::size_t{6}, std::size_t{9}}) {
    EXPECT_FALSE(solution.cam_from_shape[idx]) << idx;
  }
}

TEST(GrowMap, FrameNeedsAsManyAgreeingMarkersAsTheOptionSays) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 12, false);
  scene.frames[9].markers.resize(4);
  const SceneMap map(std::move(scene));
  for (const int min_num_inliers : {4, 5}) {
    MapSolution solution = TwoTrueFrames(map, 4, 7);
    GrowMap(map.problem, AllFrames(map.problem), {min_num_inliers, 0, true, TestSeed()}, &solution);
    EXPECT_EQ(solution.cam_from_shape[9].has_value(), min_num_inliers == 4);
    EXPECT_EQ(solution.NumRegistered(), min_num_inliers == 4 ? 12 : 11);
  }
}

TEST(GrowMap, FromNothingNothingGrows) {
  const SceneMap map(MakeScene(SceneKind::kSail, 5, false));
  MapSolution solution = EmptySolution(map.problem);
  GrowMap(map.problem, AllFrames(map.problem), {2, 0, true, TestSeed()}, &solution);
  EXPECT_EQ(solution.NumRegistered(), 0);
  EXPECT_EQ(NumPlaced(solution), 0);
}

TEST(IsSettled, AsksForOnePlaceAndEnoughAgreement) {
  const SceneMap map(MakeScene(SceneKind::kSail, 12, false));
  const MapSolution truth = map.TrueSolution();
  const auto& seen_idxs = map.problem.markers[11].observation_idxs;
  ASSERT_GE(seen_idxs.size(), 10u);
  EXPECT_TRUE(IsSettled(map.problem, truth, 11, 1.0));

  MapSolution solution = truth;
  solution.shape_from_marker[11].push_back(truth.shape_from_marker[11].front());
  EXPECT_FALSE(IsSettled(map.problem, solution, 11, 0.1)) << "two places";
  solution.shape_from_marker[11].clear();
  EXPECT_FALSE(IsSettled(map.problem, solution, 11, 0.1)) << "no place";

  // Half of the frames agree.
  solution = truth;
  for (std::size_t i = 0; i < seen_idxs.size(); i += 2) {
    solution.is_inlier[static_cast<std::size_t>(seen_idxs[i])] = 0;
  }
  EXPECT_TRUE(IsSettled(map.problem, solution, 11, 0.4));
  EXPECT_FALSE(IsSettled(map.problem, solution, 11, 0.6));
  // Those that do not agree are not registered.
  for (std::size_t i = 0; i < seen_idxs.size(); i += 2) {
    const int frame_idx = map.problem.Observation(seen_idxs[i]).frame_idx;
    solution.cam_from_shape[static_cast<std::size_t>(frame_idx)].reset();
  }
  EXPECT_TRUE(IsSettled(map.problem, solution, 11, 1.0));

  // One frame alone is no agreement.
  solution = truth;
  for (std::size_t i = 0; i < solution.cam_from_shape.size(); ++i) {
    if (static_cast<int>(i) != map.problem.Observation(seen_idxs.front()).frame_idx) {
      solution.cam_from_shape[i].reset();
    }
  }
  for (std::size_t i = 1; i < seen_idxs.size(); ++i) {
    solution.is_inlier[static_cast<std::size_t>(seen_idxs[i])] = 0;
  }
  EXPECT_FALSE(IsSettled(map.problem, solution, 11, 1.0)) << "one frame";
}

TEST(PlaceUnsettledMarkers, PutsBackWhatStandsWrongAndLeavesTheRest) {
  const SceneMap map = NoisySail(0.2, TestSeed());
  const MapSolution truth = map.TrueSolution();
  MapSolution solution = truth;
  solution.shape_from_marker[4].front().translation.x() += 0.5;
  solution.shape_from_marker[17].clear();
  MarkInliers(map.problem, 1.0, &solution);
  PlaceUnsettledMarkers(map.problem, 0.6, 1.0, 1, &solution);
  for (std::size_t idx = 0; idx < solution.shape_from_marker.size(); ++idx) {
    ASSERT_EQ(solution.shape_from_marker[idx].size(), 1u) << idx;
    const double error =
        StepBetween(truth.shape_from_marker[idx].front(), solution.shape_from_marker[idx].front())
            .norm();
    if (idx == 4 || idx == 17) {
      EXPECT_GT(error, 0.0);
      EXPECT_LT(error, 0.02);
    } else {
      EXPECT_EQ(error, 0.0);
    }
  }
  EXPECT_EQ(std::count(solution.is_inlier.begin(), solution.is_inlier.end(), 1),
            static_cast<std::ptrdiff_t>(map.problem.observations.size()));
}

}  // namespace
}  // namespace velamap
