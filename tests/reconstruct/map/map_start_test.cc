#include "reconstruct/map/map_start.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reconstruct/map/scene_map.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

using testing::IsEmpty;
using FramePair = std::pair<int, int>;

int NumShared(const SceneMap& map, const FramePair& pair) {
  int count = 0;
  for (const int idx : map.problem.Frame(pair.first).observation_idxs) {
    const int marker_idx = map.problem.Observation(idx).marker_idx;
    count += map.ObservationIdx(pair.second, map.problem.Marker(marker_idx).marker_id) >= 0;
  }
  return count;
}

FramePair Sorted(const FramePair& pair) { return std::minmax(pair.first, pair.second); }

TEST(ChooseStartPairs, FramesStartOnceAndShareEnough) {
  SyntheticScene scene = MakeScene(SceneKind::kCube, 24, false);
  AddNoise({0.2, 0.2, 0.0, 0, TestSeed()}, &scene);
  const SceneMap map(std::move(scene));
  for (const int min_num_shared : {2, 5}) {
    const auto pairs = ChooseStartPairs(map.problem, AllFrames(map.problem), 6, min_num_shared);
    EXPECT_EQ(pairs.size(), 6u);
    std::set<int> used;
    for (const FramePair& pair : pairs) {
      EXPECT_TRUE(used.insert(pair.first).second);
      EXPECT_TRUE(used.insert(pair.second).second);
      EXPECT_GE(NumShared(map, pair), min_num_shared);
    }
  }
}

TEST(ChooseStartPairs, OrderOfFramesChangesNothing) {
  const SceneMap map = NoisySail(0.2, TestSeed());
  // Neighbours, whose parallax is below 20 degrees: no two pairs are equally promising.
  std::vector<int> frame_idxs = {6, 7, 8, 9};
  std::vector<FramePair> pairs = ChooseStartPairs(map.problem, frame_idxs, 2, 2);
  std::shuffle(frame_idxs.begin(), frame_idxs.end(), std::mt19937(TestSeed()));
  std::vector<FramePair> shuffled = ChooseStartPairs(map.problem, frame_idxs, 2, 2);
  std::transform(pairs.begin(), pairs.end(), pairs.begin(), Sorted);
  std::transform(shuffled.begin(), shuffled.end(), shuffled.begin(), Sorted);
  EXPECT_EQ(pairs, shuffled);
}

TEST(ChooseStartPairs, ParallaxCountsMoreThanAFewMarkers) {
  const SceneMap map = NoisySail(0.0, 1);
  // 6 and 7 are neighbours with every marker in common; 12 looks from another side.
  ASSERT_GE(NumShared(map, {6, 7}), NumShared(map, {7, 12}));
  ASSERT_GE(NumShared(map, {7, 12}), 15);
  EXPECT_NE(Sorted(ChooseStartPairs(map.problem, {6, 7, 12}, 1, 2).at(0)), FramePair(6, 7));
}

TEST(ChooseStartPairs, WithoutCommonMarkersThereIsNoPair) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 4, false);
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    for (MarkerDetection& marker : scene.frames[i].markers) {
      marker.marker_id += static_cast<int>(100 * i);
    }
  }
  const SceneMap map(std::move(scene));
  EXPECT_THAT(ChooseStartPairs(map.problem, AllFrames(map.problem), 4, 1), IsEmpty());
}

// Truth in the cam frame of `frame_idx`.
MapSolution TruthInCamOf(const SceneMap& map, int frame_idx) {
  const Rigid3& cam_from_world = map.scene.cam_from_world[static_cast<std::size_t>(frame_idx)];
  return Transformed({1.0, cam_from_world.rotation, cam_from_world.translation},
                     map.TrueSolution());
}

TEST(StartFromPair, ExactCornersGiveTheExactMap) {
  const SceneMap map = NoisySail(0.0, 1);
  for (const FramePair& pair : {FramePair(2, 9), FramePair(12, 5)}) {
    const MapSolution start = StartFromPair(map.problem, pair, TestSeed());
    const MapSolution truth = TruthInCamOf(map, pair.first);
    ASSERT_EQ(start.NumRegistered(), 2);
    const auto first = static_cast<std::size_t>(pair.first);
    const auto second = static_cast<std::size_t>(pair.second);
    EXPECT_LT(StepBetween(Rigid3{}, *start.cam_from_shape[first]).norm(), 1e-6);
    EXPECT_LT(StepBetween(*truth.cam_from_shape[second], *start.cam_from_shape[second]).norm(),
              1e-6);
    EXPECT_LT(MaxCornerDistance(map.problem, start, truth), 1e-6);
    const auto num_placed =
        std::count_if(start.shape_from_marker.begin(), start.shape_from_marker.end(),
                      [](const auto& places) { return !places.empty(); });
    EXPECT_EQ(num_placed, NumShared(map, pair));
  }
}

TEST(StartFromPair, OrderOfThePairChangesTheFrameOfTheMapOnly) {
  const SceneMap map = NoisySail(0.2, TestSeed());
  const MapSolution forth = StartFromPair(map.problem, {2, 9}, TestSeed());
  const MapSolution back = StartFromPair(map.problem, {9, 2}, TestSeed());
  const Rigid3 back_from_forth = Inverse(*back.cam_from_shape[9]) * *forth.cam_from_shape[9];
  const MapSolution forth_in_back =
      Transformed({1.0, back_from_forth.rotation, back_from_forth.translation}, forth);
  // The sigma of the common scale is 0.4 %: 10 mm at this distance.
  EXPECT_LT(MaxCornerDistance(map.problem, forth_in_back, back), 2e-3);
  EXPECT_EQ(forth.is_inlier, back.is_inlier);
}

TEST(StartFromPair, ExplainsAsMuchAsTheTruth) {
  const SceneMap map = NoisySail(0.4, TestSeed());
  for (const FramePair& pair : {FramePair(0, 7), FramePair(4, 12), FramePair(8, 14)}) {
    const MapSolution start = StartFromPair(map.problem, pair, TestSeed());
    MapSolution truth = map.TrueSolution();
    for (std::size_t idx = 0; idx < truth.cam_from_shape.size(); ++idx) {
      if (!start.cam_from_shape[idx]) truth.cam_from_shape[idx].reset();
    }
    for (std::size_t idx = 0; idx < truth.shape_from_marker.size(); ++idx) {
      if (start.shape_from_marker[idx].empty()) truth.shape_from_marker[idx].clear();
    }
    EXPECT_GT(ExplainedObservations(map.problem, start), ExplainedObservations(map.problem, truth));
  }
}

TEST(StartFromPair, WorksWhicheverPlanarSolutionComesFirst) {
  SceneMap map = NoisySail(0.2, TestSeed());
  const MapSolution before = StartFromPair(map.problem, {3, 11}, TestSeed());
  for (MapObservation& observation : map.problem.observations) {
    std::reverse(observation.cam_from_marker.begin(), observation.cam_from_marker.end());
  }
  const MapSolution after = StartFromPair(map.problem, {3, 11}, TestSeed());
  EXPECT_EQ(before.is_inlier, after.is_inlier);
  EXPECT_LT(MaxCornerDistance(map.problem, before, after), 2e-3);
}

// Two markers of one frame have each other's id.
class StartWithFalseIds : public testing::TestWithParam<FramePair> {};

TEST_P(StartWithFalseIds, LeavesThemOut) {
  const auto [id_a, id_b] = GetParam();
  SyntheticScene scene = MakeScene(SceneKind::kSail, 15, false);
  MarkerDetection* a = FindDetection(id_a, &scene.frames[9]);
  MarkerDetection* b = FindDetection(id_b, &scene.frames[9]);
  ASSERT_TRUE(a != nullptr && b != nullptr);
  std::swap(a->corners_in_image_px, b->corners_in_image_px);
  const SceneMap map(std::move(scene));
  const MapSolution start = StartFromPair(map.problem, {4, 9}, TestSeed());
  const MapSolution truth = TruthInCamOf(map, 4);
  ASSERT_EQ(start.NumRegistered(), 2);
  EXPECT_LT(StepBetween(*truth.cam_from_shape[9], *start.cam_from_shape[9]).norm(), 1e-5);
  const int num_inliers = std::accumulate(start.is_inlier.begin(), start.is_inlier.end(), 0);
  EXPECT_EQ(num_inliers, 2 * (NumShared(map, {4, 9}) - 2));
  for (const int marker_id : {id_a, id_b}) {
    EXPECT_FALSE(start.IsInlier(map.ObservationIdx(9, marker_id)));
  }
}

INSTANTIATE_TEST_SUITE_P(Markers, StartWithFalseIds,
                         testing::Values(FramePair(8, 15), FramePair(9, 14), FramePair(1, 28)));

TEST(StartFromPair, WithoutCommonMarkersNothingIsRegistered) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 4, false);
  for (MarkerDetection& marker : scene.frames[3].markers) marker.marker_id += 500;
  const SceneMap map(std::move(scene));
  EXPECT_EQ(StartFromPair(map.problem, {1, 3}, TestSeed()).NumRegistered(), 0);
}

TEST(ExplainedObservations, IsOneForEachObservationOfThePerfectMapOnly) {
  const SceneMap map = NoisySail(0.0, 1);
  const MapSolution truth = map.TrueSolution();
  const double num_observations = static_cast<double>(map.problem.observations.size());
  EXPECT_NEAR(ExplainedObservations(map.problem, truth), num_observations, 1e-6);
  EXPECT_EQ(ExplainedObservations(map.problem, EmptySolution(map.problem)), 0.0);
  MapSolution without_one = truth;
  without_one.shape_from_marker[3].clear();
  EXPECT_NEAR(
      ExplainedObservations(map.problem, without_one),
      num_observations - static_cast<double>(map.problem.markers[3].observation_idxs.size()), 1e-6);
}

TEST(ExplainedObservations, SimilarityOfTheMapChangesNothing) {
  const SceneMap map = NoisySail(1.0, TestSeed());
  const MapSolution truth = map.TrueSolution();
  EXPECT_NEAR(ExplainedObservations(map.problem, truth),
              ExplainedObservations(map.problem, Transformed(ArbitrarySimilarity(3.7), truth)),
              1e-6);
}

TEST(ReversedRelief, TwiceGivesTheMapBack) {
  const SceneMap map = NoisySail(0.0, 1);
  const MapSolution truth = map.TrueSolution();
  const MapSolution twice = ReversedRelief(ReversedRelief(truth));
  EXPECT_LT(MaxCornerDistance(map.problem, truth, twice), 1e-9);
  for (std::size_t idx = 0; idx < truth.cam_from_shape.size(); ++idx) {
    EXPECT_LT(StepBetween(*truth.cam_from_shape[idx], *twice.cam_from_shape[idx]).norm(), 1e-9);
  }
}

TEST(ReversedRelief, KeepsDistancesBetweenMarkers) {
  const SceneMap map = NoisySail(0.0, 1);
  const MapSolution truth = map.TrueSolution(), reversed = ReversedRelief(truth);
  EXPECT_GT(MaxCornerDistance(map.problem, truth, reversed), 0.05);
  for (std::size_t a = 0; a < truth.shape_from_marker.size(); ++a) {
    for (std::size_t b = a + 1; b < truth.shape_from_marker.size(); ++b) {
      const auto distance = [a, b](const MapSolution& solution) {
        return (solution.shape_from_marker[a].front().translation -
                solution.shape_from_marker[b].front().translation)
            .norm();
      };
      EXPECT_NEAR(distance(truth), distance(reversed), 1e-12);
    }
  }
}

// RMS error of the reversed relief when all cameras stand `distance` m farther away, with a lens
// that shows the sail as large as before.
double ErrorOfReversedRelief(double distance) {
  SyntheticSceneOptions options;
  options.num_frames = 8;
  options.video = false;
  options.camera = {CameraModel::kPinhole, 1920, 1080, {1200, 1200, 960, 540}};
  SyntheticScene scene = MakeSyntheticScene(options);
  constexpr double kDistance = 2.5;
  const double zoom = (kDistance + distance) / kDistance;
  scene.camera.params[0] *= zoom;
  scene.camera.params[1] *= zoom;
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    scene.cam_from_world[i].translation.z() += distance;
    for (MarkerDetection& marker : scene.frames[i].markers) {
      const auto& points = scene.x_in_world.at(marker.marker_id);
      for (std::size_t corner = 0; corner < kNumCorners; ++corner) {
        marker.corners_in_image_px[corner] =
            ImageFromCam(scene.camera, scene.cam_from_world[i] * points[corner + 1]).value();
      }
    }
  }
  const SceneMap map(std::move(scene));
  const MapSolution reversed = ReversedRelief(map.TrueSolution());
  double sum = 0.0;
  for (const MapObservation& observation : map.problem.observations) {
    sum += std::pow(ReprojectionError(map.problem, reversed, observation), 2);
  }
  return std::sqrt(sum / static_cast<double>(map.problem.observations.size()));
}

TEST(ReversedRelief, ExplainsTheImagesOfALongLensAndNoOthers) {
  EXPECT_GT(ErrorOfReversedRelief(0.0), 5.0);
  EXPECT_LT(ErrorOfReversedRelief(500.0), 0.5);
}

}  // namespace
}  // namespace velamap
