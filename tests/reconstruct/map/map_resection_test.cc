#include "reconstruct/map/map_resection.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reconstruct/map/map_refinement.h"
#include "tests/reconstruct/map/scene_map.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

using testing::IsEmpty;

// The pose of this frame is what is asked for.
MapSolution Without(int frame_idx, MapSolution solution) {
  solution.cam_from_shape[static_cast<std::size_t>(frame_idx)].reset();
  return solution;
}

double Error(const MapSolution& truth, int frame_idx, const PoseHypothesis& hypothesis) {
  return StepBetween(*truth.Pose(frame_idx), hypothesis.cam_from_space).norm();
}

TEST(ResectFrame, ExactCornersGiveTheExactPose) {
  const SceneMap map = NoisySail(0.0, 1);
  const MapSolution truth = map.TrueSolution();
  for (int frame_idx = 0; frame_idx < 15; ++frame_idx) {
    const auto hypotheses =
        ResectFrame(map.problem, Without(frame_idx, truth), frame_idx, 1.0, TestSeed());
    ASSERT_FALSE(hypotheses.empty());
    EXPECT_LT(Error(truth, frame_idx, hypotheses.front()), 1e-9);
    EXPECT_EQ(hypotheses.front().inlier_idxs, map.problem.Frame(frame_idx).observation_idxs);
    EXPECT_LT(hypotheses.front().cost, 1e-12);
    EXPECT_FALSE(IsAmbiguous(hypotheses));
  }
}

TEST(ResectFrame, HypothesesAreRankedAndFew) {
  const SceneMap map = NoisySail(1.0, TestSeed());
  for (int frame_idx = 0; frame_idx < 15; ++frame_idx) {
    const auto hypotheses =
        ResectFrame(map.problem, map.TrueSolution(), frame_idx, 3.0, TestSeed());
    EXPECT_LE(hypotheses.size(), 3u);
    for (std::size_t i = 0; i < hypotheses.size(); ++i) {
      const auto& idxs = hypotheses[i].inlier_idxs;
      EXPECT_TRUE(std::is_sorted(idxs.begin(), idxs.end()));
      // A marker that does not agree costs 1, one that does at most 1.
      const double num_known =
          static_cast<double>(map.problem.Frame(frame_idx).observation_idxs.size());
      EXPECT_GE(hypotheses[i].cost, num_known - static_cast<double>(idxs.size()));
      EXPECT_LE(hypotheses[i].cost, num_known);
      if (i > 0) {
        EXPECT_LE(hypotheses[i - 1].cost, hypotheses[i].cost);
      }
    }
  }
}

TEST(ResectFrame, SimilarityOfTheMapChangesNothing) {
  const SceneMap map = NoisySail(0.3, TestSeed());
  const MapSolution truth = map.TrueSolution();
  const Sim3 new_from_shape = ArbitrarySimilarity(3.7);
  const MapSolution moved = Transformed(new_from_shape, truth);
  for (const int frame_idx : {0, 7, 14}) {
    const auto idx = static_cast<std::size_t>(frame_idx);
    MapSolution resected = truth;
    resected.cam_from_shape[idx] =
        ResectFrame(map.problem, truth, frame_idx, 1.0, TestSeed()).front().cam_from_space;
    const auto in_moved = ResectFrame(map.problem, moved, frame_idx, 1.0, TestSeed());
    EXPECT_LT(StepBetween(*Transformed(new_from_shape, resected).cam_from_shape[idx],
                          in_moved.front().cam_from_space)
                  .norm(),
              1e-5);
  }
}

TEST(ResectFrame, SeedDecidesNothingThatMatters) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 15, false);
  AddNoise({0.3, 0.0, 0.2, 200, TestSeed()}, &scene);
  const SceneMap map(std::move(scene));
  const MapSolution truth = map.TrueSolution();
  for (int frame_idx = 0; frame_idx < 15; ++frame_idx) {
    const auto first = ResectFrame(map.problem, truth, frame_idx, 1.0, 1).front();
    const auto second = ResectFrame(map.problem, truth, frame_idx, 1.0, 2).front();
    EXPECT_EQ(first.inlier_idxs, second.inlier_idxs);
    EXPECT_LT(StepBetween(first.cam_from_space, second.cam_from_space).norm(), 1e-5);
  }
}

// map_refinement_test.cc checks how good that is.
TEST(ResectFrame, ThePoseIsTheRefinedOne) {
  const SceneMap map = NoisySail(0.4, TestSeed());
  const MapSolution truth = map.TrueSolution();
  for (int frame_idx = 0; frame_idx < 15; ++frame_idx) {
    const auto best = ResectFrame(map.problem, truth, frame_idx, 1.0, TestSeed()).front();
    EXPECT_EQ(best.inlier_idxs, map.problem.Frame(frame_idx).observation_idxs);
    std::vector<PlacedObservation> placed;
    for (const int idx : best.inlier_idxs) {
      const MapObservation& observation = map.problem.Observation(idx);
      placed.push_back({&observation, &truth.Places(observation.marker_idx).front()});
    }
    const Rigid3 refined = RefineFramePose(map.problem, placed, *truth.Pose(frame_idx));
    EXPECT_LT(StepBetween(refined, best.cam_from_space).norm(), 1e-5);
  }
}

TEST(ResectFrame, FalseIdsAndTurnedCornersAreLeftOut) {
  const SyntheticScene clean = MakeScene(SceneKind::kSail, 15, false);
  SyntheticScene scene = clean;
  ExchangeIds(0.3, TestSeed(), &scene);
  TurnCorners(0.1, TestSeed() + 1, &scene);
  SceneMap map(std::move(scene));
  SetSigma(0.2, &map.problem);
  const MapSolution truth = map.TrueSolution();
  int num_false = 0;
  for (int frame_idx = 0; frame_idx < 15; ++frame_idx) {
    std::vector<int> right;
    for (const MarkerDetection& marker :
         clean.frames[static_cast<std::size_t>(frame_idx)].markers) {
      auto spoilt = map.images[static_cast<std::size_t>(frame_idx)].detections;
      const MarkerDetection* found = FindDetection(marker.marker_id, &spoilt);
      if (found != nullptr && found->corners_in_image_px == marker.corners_in_image_px) {
        right.push_back(map.ObservationIdx(frame_idx, marker.marker_id));
      } else {
        ++num_false;
      }
    }
    const auto hypotheses = ResectFrame(map.problem, truth, frame_idx, 1.0, TestSeed());
    EXPECT_EQ(hypotheses.front().inlier_idxs, right);
    EXPECT_LT(Error(truth, frame_idx, hypotheses.front()), 1e-9);
  }
  EXPECT_GT(num_false, 100);
}

TEST(ResectFrame, WorksWhicheverPlanarSolutionComesFirst) {
  SceneMap map = NoisySail(0.2, TestSeed());
  const MapSolution truth = map.TrueSolution();
  const auto before = ResectFrame(map.problem, truth, 5, 1.0, 1).front();
  for (MapObservation& observation : map.problem.observations) {
    std::reverse(observation.cam_from_marker.begin(), observation.cam_from_marker.end());
  }
  const auto after = ResectFrame(map.problem, truth, 5, 1.0, 1).front();
  EXPECT_LT(StepBetween(before.cam_from_space, after.cam_from_space).norm(), 1e-5);
}

TEST(ResectFrame, OfTwoPlacesTheOneThatFitsIsUsed) {
  const SceneMap map = NoisySail(0.0, 1);
  const MapSolution truth = map.TrueSolution();
  MapSolution doubtful = truth;
  for (std::size_t idx = 0; idx < doubtful.shape_from_marker.size(); idx += 2) {
    // The wrong place first: turned out of its plane by half a right angle.
    auto& places = doubtful.shape_from_marker[idx];
    Sim3 wrong = places.front();
    wrong.rotation = wrong.rotation * Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitX());
    places.insert(places.begin(), wrong);
  }
  for (const int frame_idx : {0, 7, 14}) {
    const auto best = ResectFrame(map.problem, doubtful, frame_idx, 1.0, TestSeed()).front();
    EXPECT_LT(Error(truth, frame_idx, best), 1e-9);
    EXPECT_EQ(best.inlier_idxs, map.problem.Frame(frame_idx).observation_idxs);
  }
}

TEST(ResectFrame, FrameWithoutAKnownMarkerHasNoPose) {
  const SceneMap map = NoisySail(0.0, 1);
  EXPECT_THAT(ResectFrame(map.problem, EmptySolution(map.problem), 3, 1.0, 1), IsEmpty());
}

// One small marker through a long lens: perspective does not tell its two orientations apart.
SceneMap DistantMarker(std::uint32_t seed) {
  SyntheticSceneOptions options;
  options.kind = SceneKind::kPlane;
  options.num_rows = options.num_columns = 1;
  options.num_frames = 5;
  options.video = false;
  options.spacing_m = 5.0;
  options.marker_length_m = 0.05;
  options.camera = {CameraModel::kPinhole, 1920, 1080, {4000, 4000, 960, 540}};
  SyntheticScene scene = MakeSyntheticScene(options);
  AddNoise({0.3, 0.0, 0.0, 0, seed}, &scene);
  return SceneMap(std::move(scene));
}

TEST(ResectFrame, OneDistantMarkerIsAmbiguous) {
  const SceneMap map = DistantMarker(TestSeed());
  const MapSolution truth = map.TrueSolution();
  for (const int frame_idx : {0, 1, 3, 4}) {  // 2 looks straight on, where the two are one
    ASSERT_EQ(map.problem.Frame(frame_idx).observation_idxs.size(), 1u);
    const auto hypotheses = ResectFrame(map.problem, truth, frame_idx, 1.0, 1);
    ASSERT_EQ(hypotheses.size(), 2u) << frame_idx;
    EXPECT_TRUE(IsAmbiguous(hypotheses)) << frame_idx;
    // One of the two is the right one.
    const Rigid3& true_pose = *truth.Pose(frame_idx);
    EXPECT_LT(std::min(AngularDistance(true_pose, hypotheses[0].cam_from_space),
                       AngularDistance(true_pose, hypotheses[1].cam_from_space)),
              0.15);
  }
}

TEST(IsAmbiguous, ComparesCostAndSupportOfTheFirstTwo) {
  const std::vector<int> five = {0, 1, 2, 3, 4};
  const auto with = [&](double cost, std::vector<int> idxs) {
    return std::vector<PoseHypothesis>{{Rigid3{}, 1.0, five}, {Rigid3{}, cost, std::move(idxs)}};
  };
  EXPECT_FALSE(IsAmbiguous(std::vector<PoseHypothesis>()));
  EXPECT_FALSE(IsAmbiguous(std::vector<PoseHypothesis>{{Rigid3{}, 1.0, five}}));
  EXPECT_TRUE(IsAmbiguous(with(1.9, five)));
  EXPECT_FALSE(IsAmbiguous(with(2.1, five)));
  EXPECT_FALSE(IsAmbiguous(with(1.9, {0, 1, 2, 3})));
}

}  // namespace
}  // namespace velamap
