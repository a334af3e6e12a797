#include "reconstruct/map/map_verdict.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "reconstruct/map/map_refinement.h"
#include "tests/reconstruct/map/scene_map.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

TEST(EstimateNoise, IsZeroForExactCorners) {
  const SceneMap map = NoisySail(0.0, 1);
  const MapNoise noise = EstimateNoise(map.problem, map.TrueSolution());
  EXPECT_LT(noise.sigma_px, 1e-6);
  EXPECT_LT(noise.factor, 1e-5);
  EXPECT_LT(noise.single_marker_sigma_px, 1e-6);
}

class NoiseOfMap : public testing::TestWithParam<double> {};

TEST_P(NoiseOfMap, IsThatOfTheCorners) {
  const double sigma_px = GetParam();
  const SceneMap map = NoisySail(sigma_px, TestSeed());
  const MapNoise noise = EstimateNoise(map.problem, map.TrueSolution());
  // Medians over some 400 observations of 8 coordinates: a sigma of 2 %, alone (of 2) of 5 %.
  EXPECT_NEAR(noise.sigma_px / sigma_px, 1.0, 0.08);
  EXPECT_NEAR(noise.factor, 1.0, 0.08);
  EXPECT_NEAR(noise.single_marker_sigma_px / sigma_px, 1.0, 0.3);
  for (const double factor : noise.factor_of_frame) EXPECT_NEAR(factor, 1.0, 0.4);
}

INSTANTIATE_TEST_SUITE_P(Sigmas, NoiseOfMap, testing::Values(0.1, 0.4, 1.5));

TEST(EstimateNoise, SimilarityOfTheMapChangesNothing) {
  const SceneMap map = NoisySail(0.4, TestSeed());
  const MapSolution truth = map.TrueSolution();
  const MapNoise noise = EstimateNoise(map.problem, truth);
  const MapNoise moved = EstimateNoise(map.problem, Transformed(ArbitrarySimilarity(0.2), truth));
  EXPECT_NEAR(noise.sigma_px, moved.sigma_px, 1e-9);
  EXPECT_NEAR(noise.factor, moved.factor, 1e-9);
}

TEST(EstimateNoise, FactorCountsInUnitsOfTheGivenSigma) {
  SceneMap map = NoisySail(0.4, TestSeed());
  const MapNoise noise = EstimateNoise(map.problem, map.TrueSolution());
  SetSigma(0.1, &map.problem);
  const MapNoise in_quarters = EstimateNoise(map.problem, map.TrueSolution());
  EXPECT_NEAR(in_quarters.factor, 4 * noise.factor, 1e-9);
  EXPECT_NEAR(in_quarters.sigma_px, noise.sigma_px, 1e-9);
}

TEST(EstimateNoise, ATenthOfOutliersChangesLittle) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 15, false);
  AddNoise({0.4, 0.0, 0.1, 50, TestSeed()}, &scene);
  SceneMap map(std::move(scene));
  SetSigma(0.4, &map.problem);
  EXPECT_NEAR(EstimateNoise(map.problem, map.TrueSolution()).factor, 1.0, 0.15);
}

TEST(EstimateNoise, UsesOnlyWhatFits) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 15, false);
  AddNoise({0.4, 0.0, 0.6, 50, TestSeed()}, &scene);
  const SceneMap map(std::move(scene));
  MapSolution solution = map.TrueSolution();
  MarkInliers(map.problem, 1.0, &solution);
  EXPECT_NEAR(EstimateNoise(map.problem, solution).sigma_px, 0.4, 0.06);
  std::fill(solution.is_inlier.begin(), solution.is_inlier.end(), 0);
  EXPECT_EQ(EstimateNoise(map.problem, solution).factor, 1.0);
}

TEST(EstimateNoise, BlurredFrameHasALargeFactorAndAnUnregisteredOneNone) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 15, false);
  AddNoise({0.3, 0.0, 0.0, 0, TestSeed()}, &scene);
  BlurFrames(1.5, TestSeed() + 1, &scene);  // frame 5 alone
  SceneMap map(std::move(scene));
  SetSigma(0.3, &map.problem);
  MapSolution solution = map.TrueSolution();
  solution.cam_from_shape[9].reset();
  for (const int idx : map.problem.Frame(9).observation_idxs) {
    solution.is_inlier[static_cast<std::size_t>(idx)] = 0;
  }
  const MapNoise noise = EstimateNoise(map.problem, solution);
  EXPECT_NEAR(noise.factor_of_frame[5], std::sqrt(1 + 25.0), 1.5);
  EXPECT_EQ(noise.factor_of_frame[9], 0.0);
  EXPECT_NEAR(noise.factor, 1.0, 0.12);
}

TEST(FinalTolerance, GrowsWithTheNoiseOfMapFrameAndMarker) {
  MapObservation observation;
  observation.sigma_px = 0.2;
  MapNoise noise;
  noise.factor_of_frame = noise.factor_of_marker = {0.0};
  noise.factor = 1.0;
  const double at_1 = FinalTolerance(observation, noise);
  // Beyond what the RMS of four corners with 0.2 px in each coordinate can be by chance.
  EXPECT_GT(at_1, 3 * std::sqrt(2.0) * observation.sigma_px);
  noise.factor = 2.0;
  EXPECT_DOUBLE_EQ(FinalTolerance(observation, noise), 2 * at_1);
  noise.factor_of_frame = {4.0};
  EXPECT_DOUBLE_EQ(FinalTolerance(observation, noise), 4 * at_1);
  observation.sigma_px = 0.4;
  EXPECT_DOUBLE_EQ(FinalTolerance(observation, noise), 8 * at_1);
  noise.factor_of_marker = {6.0};
  EXPECT_DOUBLE_EQ(FinalTolerance(observation, noise), 12 * at_1);
  // Exact corners do not make it zero.
  noise.factor = noise.factor_of_frame[0] = noise.factor_of_marker[0] = 0.0;
  EXPECT_GT(FinalTolerance(observation, noise), 0.1 * at_1);
}

TEST(MarkFinalInliers, KeepsGoodCornersAndNothingElse) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 15, false);
  AddNoise({0.3, 0.0, 0.0, 0, TestSeed()}, &scene);
  std::set<std::pair<int, int>> spoilt;  // frame_idx, marker_id
  for (int i = 0; i < 15; i += 2) {
    MarkerDetection& marker = scene.frames[static_cast<std::size_t>(i)].markers[6];
    marker.corners_in_image_px[1].x() += 8.0;
    spoilt.insert({i, marker.marker_id});
  }
  SceneMap map(std::move(scene));
  SetSigma(0.3, &map.problem);
  MapSolution solution = map.TrueSolution();
  solution.cam_from_shape[9].reset();
  solution.shape_from_marker[20].clear();
  MarkInliers(map.problem, 1.0, &solution);
  MarkFinalInliers(map.problem, EstimateNoise(map.problem, solution), &solution);
  for (std::size_t idx = 0; idx < map.problem.observations.size(); ++idx) {
    const MapObservation& observation = map.problem.observations[idx];
    const int marker_id = map.problem.Marker(observation.marker_idx).marker_id;
    const bool is_good = observation.frame_idx != 9 && observation.marker_idx != 20 &&
                         spoilt.count({observation.frame_idx, marker_id}) == 0;
    EXPECT_EQ(solution.is_inlier[idx] != 0, is_good) << observation.frame_idx << " " << marker_id;
  }
}

TEST(IsSuspicious, ComparesTheMapWithSingleMarkers) {
  const auto noise_of = [](double sigma_px, double single_marker_sigma_px) {
    MapNoise noise;
    noise.sigma_px = sigma_px;
    noise.single_marker_sigma_px = single_marker_sigma_px;
    return noise;
  };
  EXPECT_FALSE(IsSuspicious(noise_of(0.4, 0.4)));
  EXPECT_FALSE(IsSuspicious(noise_of(0.7, 0.35))) << "lens and cloth";
  EXPECT_TRUE(IsSuspicious(noise_of(1.5, 0.2)));
  EXPECT_FALSE(IsSuspicious(noise_of(0.05, 0.001))) << "a small part of a pixel";
}

TEST(IsSuspicious, TrueMapIsNotAndWrongReliefIs) {
  const SceneMap map = NoisySail(0.3, TestSeed());
  MapSolution solution = map.TrueSolution();
  EXPECT_FALSE(IsSuspicious(EstimateNoise(map.problem, solution)));
  // A sail of half the depth.
  for (auto& places : solution.shape_from_marker) places.front().translation.y() *= 0.5;
  EXPECT_TRUE(IsSuspicious(EstimateNoise(map.problem, solution)));
}

class WhyOutlierTest : public testing::Test {
 protected:
  // Why marker 8 of frame 6 does not fit after `spoil` has changed its detection.
  template <typename Spoil>
  std::string Why(const Spoil& spoil) {
    SyntheticScene scene = MakeScene(SceneKind::kSail, 12, false);
    spoil(FindDetection(8, &scene.frames[6]), FindDetection(15, &scene.frames[6]));
    const SceneMap map(std::move(scene));
    MapSolution solution = map.TrueSolution();
    MarkInliers(map.problem, 1.0, &solution);
    return OutlierReason(map.problem, solution, EstimateNoise(map.problem, solution),
                         map.problem.Observation(map.ObservationIdx(6, 8)));
  }
};

TEST_F(WhyOutlierTest, IdOfAnotherMarker) {
  EXPECT_EQ(Why([](MarkerDetection* marker, MarkerDetection* other) {
              std::swap(marker->corners_in_image_px, other->corners_in_image_px);
            }),
            "wrong id: marker 15 is there");
}

TEST_F(WhyOutlierTest, TurnedCorners) {
  for (const int quarters : {1, 2, 3}) {
    EXPECT_EQ(Why([&](MarkerDetection* marker, MarkerDetection*) {
                auto& corners = marker->corners_in_image_px;
                std::rotate(corners.begin(), corners.begin() + 4 - quarters, corners.end());
              }),
              "corners numbered from the wrong one, turned by " + std::to_string(90 * quarters) +
                  " degrees");
  }
}

TEST_F(WhyOutlierTest, SingleCorners) {
  EXPECT_EQ(Why([](MarkerDetection* marker, MarkerDetection*) {
              marker->corners_in_image_px[2].x() += 12.0;
            }),
            "corner 3 off by 12 px");
  EXPECT_EQ(Why([](MarkerDetection* marker, MarkerDetection*) {
              marker->corners_in_image_px[0].y() += 5.5;
              marker->corners_in_image_px[3].x() += 12.0;
            }),
            "corner 1 off by 5.5 px, 4 off by 12 px");
}

TEST_F(WhyOutlierTest, AnythingElse) {
  EXPECT_EQ(Why([](MarkerDetection* marker, MarkerDetection*) {
              for (Eigen::Vector2d& corner : marker->corners_in_image_px) corner.x() += 16.0;
            }),
            "16 px from its place");
}

// The marker in the middle of the sail.
constexpr int kMiddleId = 14;

TEST(SupportOf, MarkerIsSeenWhereItShouldBe) {
  const SceneMap map = NoisySail(0.2, TestSeed());
  const MapSolution truth = map.TrueSolution();
  const MapNoise noise = EstimateNoise(map.problem, truth);
  for (std::size_t idx = 0; idx < map.problem.markers.size(); ++idx) {
    const int marker_idx = static_cast<int>(idx);
    const PlacedMarker placed = SupportOf(map.problem, truth, noise, marker_idx);
    EXPECT_EQ(placed.marker_id, map.problem.Marker(marker_idx).marker_id);
    EXPECT_EQ(placed.num_seen, map.problem.Marker(marker_idx).observation_idxs.size());
    EXPECT_GT(placed.num_should_see, 0);
    // The scene leaves nothing out, but what it turns away and what is near the border.
    EXPECT_EQ(placed.num_seen_of_these, placed.num_should_see);
  }
}

TEST(SupportOf, ImagesThatMissItAreCounted) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 20, false);
  int num_missing = 0;
  for (std::size_t i = 3; i < scene.frames.size(); ++i) {
    num_missing += RemoveDetection(kMiddleId, &scene.frames[i]);
  }
  ASSERT_GT(num_missing, 10);
  const SceneMap map(std::move(scene));
  const MapSolution truth = map.TrueSolution();
  const PlacedMarker placed =
      SupportOf(map.problem, truth, EstimateNoise(map.problem, truth), map.MarkerIdx(kMiddleId));
  EXPECT_LE(placed.num_seen, 3);
  EXPECT_GT(placed.num_should_see, placed.num_seen_of_these + num_missing / 4);
}

TEST(SupportOf, SigmaIsThatOfTheCentreAndScalesWithTheMap) {
  const SceneMap map = NoisySail(0.4, TestSeed());
  const MapSolution truth = map.TrueSolution();
  const MapNoise noise = EstimateNoise(map.problem, truth);
  const int marker_idx = map.MarkerIdx(kMiddleId);
  const PlacedMarker placed = SupportOf(map.problem, truth, noise, marker_idx);
  EXPECT_GT(placed.sigma_m, 1e-5);
  EXPECT_LT(placed.sigma_m, 0.01);  // 15 views of 0.4 px
  const double scale = 7.0;
  const MapSolution moved = Transformed(ArbitrarySimilarity(scale), truth);
  const PlacedMarker scaled = SupportOf(map.problem, moved, noise, marker_idx);
  EXPECT_NEAR(scaled.sigma_m / placed.sigma_m, scale, 1e-6 * scale);
  EXPECT_EQ(scaled.num_should_see, placed.num_should_see);
  // Fewer views know it less.
  MapSolution fewer = truth;
  const auto& observation_idxs = map.problem.Marker(marker_idx).observation_idxs;
  for (std::size_t i = 2; i < observation_idxs.size(); ++i) {
    fewer.is_inlier[static_cast<std::size_t>(observation_idxs[i])] = 0;
  }
  EXPECT_GT(SupportOf(map.problem, fewer, noise, marker_idx).sigma_m, placed.sigma_m);
}

// The sigma of a marker that only one frame sees, divided by its distance from it. The frame shows
// it `num_times`, as frames at the same place would.
double DistanceSigmaOfOneView(SceneMap map, int num_times, double* size_sigma) {
  MapSolution solution = map.TrueSolution();
  MapNoise noise;
  noise.factor_of_frame.assign(map.problem.frames.size(), 1.0);
  noise.factor_of_marker.assign(map.problem.markers.size(), 0.0);
  const int marker_idx = map.MarkerIdx(kMiddleId);
  std::vector<int>& idxs =
      map.problem.markers[static_cast<std::size_t>(marker_idx)].observation_idxs;
  const MapObservation observation = map.problem.Observation(idxs.front());
  idxs = {idxs.front()};
  for (int i = 1; i < num_times; ++i) {
    idxs.push_back(static_cast<int>(map.problem.observations.size()));
    map.problem.observations.push_back(observation);
    solution.is_inlier.push_back(1);
  }
  const Rigid3& pose = *solution.Pose(observation.frame_idx);
  *size_sigma = observation.sigma_px / observation.side_px;
  return SupportOf(map.problem, solution, noise, marker_idx).sigma_m /
         (pose * map.TruePlace(marker_idx).translation).norm();
}

TEST(SupportOf, ErrorOfTheSideIsTheSameInAllFrames) {
  for (const int num_views : {1, 100}) {
    double size_sigma = 0.0;
    const double sigma = DistanceSigmaOfOneView(NoisySail(0.4, TestSeed()), num_views, &size_sigma);
    EXPECT_NEAR(sigma, std::hypot(kScaleSigma, size_sigma / std::sqrt(num_views)), 1e-9);
  }
}

TEST(SupportOf, OrderOfTheFramesChangesNothing) {
  SceneMap map = NoisySail(0.4, TestSeed());
  const MapSolution truth = map.TrueSolution();
  const MapNoise noise = EstimateNoise(map.problem, truth);
  const int marker_idx = map.MarkerIdx(kMiddleId);
  const double sigma_m = SupportOf(map.problem, truth, noise, marker_idx).sigma_m;
  auto& idxs = map.problem.markers[static_cast<std::size_t>(marker_idx)].observation_idxs;
  std::reverse(idxs.begin(), idxs.end());
  EXPECT_NEAR(SupportOf(map.problem, truth, noise, marker_idx).sigma_m / sigma_m, 1.0, 1e-9);
}

}  // namespace
}  // namespace velamap
