#include "reconstruct/map/map_refinement.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/reconstruct/map/scene_map.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

using PoseStep = Eigen::Matrix<double, 6, 1>;
using PlaceStep = Eigen::Matrix<double, 7, 1>;

PoseStep LargePoseStep() {
  return (PoseStep() << 0.01, -0.02, 0.015, 0.02, -0.03, 0.04).finished();
}

std::vector<PlacedObservation> PlacedObservations(const MapProblem& problem,
                                                  const MapSolution& solution, int frame_idx) {
  std::vector<PlacedObservation> placed;
  for (const int idx : problem.Frame(frame_idx).observation_idxs) {
    const MapObservation& observation = problem.Observation(idx);
    placed.push_back({&observation, &solution.Places(observation.marker_idx).front()});
  }
  return placed;
}

// The loss that the header promises, over all observations.
double CauchyCost(const std::vector<double>& squared_errors) {
  constexpr double kScale = 4.0 * 4.0 * 8;
  double cost = 0.0;
  for (const double squared : squared_errors) cost += 0.5 * kScale * std::log1p(squared / kScale);
  return cost;
}

double FrameCost(const MapProblem& problem, const std::vector<PlacedObservation>& placed,
                 const Rigid3& pose) {
  std::vector<double> squared_errors;
  for (const PlacedObservation& p : placed) {
    squared_errors.push_back(
        Residuals(problem, *p.observation, pose, *p.shape_from_marker).squaredNorm());
  }
  return CauchyCost(squared_errors);
}

double MarkerCost(const MapProblem& problem, const MapSolution& solution,
                  const std::vector<int>& observation_idxs, const Sim3& place) {
  std::vector<double> squared_errors;
  for (const int idx : observation_idxs) {
    const MapObservation& observation = problem.Observation(idx);
    squared_errors.push_back(
        Residuals(problem, observation, *solution.Pose(observation.frame_idx), place)
            .squaredNorm());
  }
  return CauchyCost(squared_errors) + 0.5 * std::pow(std::log(place.scale) / kScaleSigma, 2);
}

TEST(RefineFramePose, ExactCornersGiveTheExactPose) {
  const SceneMap map = NoisySail(0.0, 1);
  const MapSolution truth = map.TrueSolution();
  for (std::size_t idx = 0; idx < map.images.size(); ++idx) {
    const Rigid3 start = Stepped(*truth.cam_from_shape[idx], LargePoseStep());
    const Rigid3 pose = RefineFramePose(
        map.problem, PlacedObservations(map.problem, truth, static_cast<int>(idx)), start);
    EXPECT_LT(StepBetween(*truth.cam_from_shape[idx], pose).norm(), 1e-9) << idx;
  }
}

TEST(RefineFramePose, ChoiceOfTheShapeFrameChangesNothing) {
  const SceneMap map = NoisySail(0.3, TestSeed());
  const MapSolution truth = map.TrueSolution();
  const Sim3 new_from_shape = ArbitrarySimilarity(1.0);
  const MapSolution moved = Transformed(new_from_shape, truth);
  const Rigid3 pose = RefineFramePose(map.problem, PlacedObservations(map.problem, truth, 4),
                                      *truth.cam_from_shape[4]);
  const Rigid3 moved_pose = RefineFramePose(map.problem, PlacedObservations(map.problem, moved, 4),
                                            *moved.cam_from_shape[4]);
  MapSolution refined = truth;
  refined.cam_from_shape[4] = pose;
  const Rigid3 expected = *Transformed(new_from_shape, refined).cam_from_shape[4];
  // Far within the pose's sigma of 0.2 mm: the steps end where the cost falls by less than 1e-7.
  EXPECT_LT(StepBetween(expected, moved_pose).norm(), 1e-6);
}

TEST(RefineFramePose, EndsAtAMinimumOfTheCauchyLoss) {
  const SceneMap map = NoisySail(0.5, TestSeed());
  const MapSolution truth = map.TrueSolution();
  for (int frame_idx = 0; frame_idx < 15; frame_idx += 7) {
    const auto placed = PlacedObservations(map.problem, truth, frame_idx);
    const Rigid3 pose =
        RefineFramePose(map.problem, placed, Stepped(*truth.Pose(frame_idx), LargePoseStep()));
    const double cost = FrameCost(map.problem, placed, pose);
    for (int i = 0; i < 6; ++i) {
      for (const double size : {-1e-4, 1e-4}) {
        EXPECT_LT(cost, FrameCost(map.problem, placed, Stepped(pose, size * PoseStep::Unit(i))))
            << "frame " << frame_idx << ", direction " << i;
      }
    }
  }
}

TEST(RefineFramePose, ErrorsAreAsLargeAsTheNoiseExplains) {
  const SceneMap map = NoisySail(0.4, TestSeed());
  const MapSolution truth = map.TrueSolution();
  double sum = 0.0;
  for (std::size_t idx = 0; idx < map.images.size(); ++idx) {
    const int frame_idx = static_cast<int>(idx);
    const Rigid3& true_pose = *truth.cam_from_shape[idx];
    const PoseStep error = StepBetween(
        true_pose,
        RefineFramePose(map.problem, PlacedObservations(map.problem, truth, frame_idx), true_pose));
    sum += error.dot(PoseInformation(map.problem, truth, frame_idx) * error);
  }
  // Chi-square with 6 degrees of freedom a frame: the mean of 15 is 6 with a sigma of 0.9.
  EXPECT_NEAR(sum / 15, 6.0, 3.2);
}

TEST(RefineFramePose, OneWrongMarkerMovesThePoseByLessThanItsSigma) {
  SceneMap map = NoisySail(0.0, 1);
  const MapSolution truth = map.TrueSolution();
  auto placed = PlacedObservations(map.problem, truth, 7);
  ASSERT_GT(placed.size(), 20u);
  placed[3].shape_from_marker = placed[12].shape_from_marker;  // a marker at another one's place
  const PoseStep error = StepBetween(
      *truth.cam_from_shape[7], RefineFramePose(map.problem, placed, *truth.cam_from_shape[7]));
  EXPECT_LT(error.dot(PoseInformation(map.problem, truth, 7) * error), 1.0);
}

TEST(RefineMarkerPlace, ExactCornersGiveTheExactPlace) {
  const SceneMap map = NoisySail(0.0, 1);
  const MapSolution truth = map.TrueSolution();
  const PlaceStep step = (PlaceStep() << 0.05, -0.08, 0.06, 0.005, -0.01, 0.008, 0.02).finished();
  for (std::size_t idx = 0; idx < map.problem.markers.size(); ++idx) {
    const Sim3& true_place = truth.shape_from_marker[idx].front();
    const Sim3 place = RefineMarkerPlace(
        map.problem, truth, map.problem.markers[idx].observation_idxs, Stepped(true_place, step));
    EXPECT_LT(StepBetween(true_place, place).norm(), 1e-9) << idx;
  }
}

TEST(RefineMarkerPlace, ChoiceOfTheShapeFrameChangesNothing) {
  const SceneMap map = NoisySail(0.3, TestSeed());
  const MapSolution truth = map.TrueSolution();
  const Sim3 new_from_shape = ArbitrarySimilarity(1.0);
  const MapSolution moved = Transformed(new_from_shape, truth);
  const auto& observation_idxs = map.problem.markers[11].observation_idxs;
  MapSolution refined = truth;
  refined.shape_from_marker[11] = {
      RefineMarkerPlace(map.problem, truth, observation_idxs, truth.shape_from_marker[11].front())};
  const Sim3 moved_place =
      RefineMarkerPlace(map.problem, moved, observation_idxs, moved.shape_from_marker[11].front());
  EXPECT_LT(
      StepBetween(Transformed(new_from_shape, refined).shape_from_marker[11].front(), moved_place)
          .norm(),
      1e-5);
}

TEST(RefineMarkerPlace, EndsAtAMinimumOfLossAndPrior) {
  SceneMap map = NoisySail(0.5, TestSeed());
  const MapSolution truth = map.TrueSolution();
  for (int marker_idx = 0; marker_idx < 30; marker_idx += 9) {
    const auto& idxs = map.problem.Marker(marker_idx).observation_idxs;
    const Sim3 place = RefineMarkerPlace(map.problem, truth, idxs, map.TruePlace(marker_idx));
    const double cost = MarkerCost(map.problem, truth, idxs, place);
    for (int i = 0; i < 7; ++i) {
      for (const double size : {-3e-4, 3e-4}) {
        EXPECT_LT(cost,
                  MarkerCost(map.problem, truth, idxs, Stepped(place, size * PlaceStep::Unit(i))))
            << "marker " << marker_idx << ", direction " << i;
      }
    }
  }
}

TEST(RefineMarkerPlace, ErrorsAreAsLargeAsTheNoiseExplains) {
  const SceneMap map = NoisySail(0.4, TestSeed());
  const MapSolution truth = map.TrueSolution();
  double sum = 0.0;
  for (int marker_idx = 0; marker_idx < 30; ++marker_idx) {
    const Sim3 true_place = map.TruePlace(marker_idx);
    const PlaceStep error = StepBetween(
        true_place, RefineMarkerPlace(map.problem, truth,
                                      map.problem.Marker(marker_idx).observation_idxs, true_place));
    auto information = PlaceInformation(map.problem, truth, marker_idx);
    information(6, 6) += 1 / (kScaleSigma * kScaleSigma);
    sum += error.dot(information * error);
  }
  // At most chi-square with 7 degrees of freedom a marker: the prior's centre is the truth here,
  // so that the scale's part is below 1. The mean of 30 has a sigma of 0.7.
  EXPECT_GT(sum / 30, 3.5);
  EXPECT_LT(sum / 30, 9.1);
}

TEST(RefineMarkerPlace, SeveralViewsOutweighTheNominalSize) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 15, false);
  scene.layout.marker_lengths_m[11] = scene.layout.marker_length_m / 1.05;
  const SceneMap map(std::move(scene));
  const MapSolution truth = map.TrueSolution();
  const Sim3 place = RefineMarkerPlace(map.problem, truth, map.problem.markers[11].observation_idxs,
                                       map.TruePlace(11));
  EXPECT_NEAR(place.scale, 1.05, 0.002);
}

TEST(RefineMarkerPlace, OneViewLeavesTheSizeToThePrior) {
  const SceneMap map = NoisySail(0.0, 1);
  const MapSolution truth = map.TrueSolution();
  const int idx = map.problem.markers[11].observation_idxs.front();
  // Twice as large at twice the distance: one view cannot tell.
  const Rigid3 cam_from_shape = *truth.Pose(map.problem.Observation(idx).frame_idx);
  const Sim3 true_place = map.TruePlace(11);
  const Eigen::Vector3d center = Inverse(cam_from_shape).translation;
  const Sim3 start = {1.1, true_place.rotation, center + 1.1 * (true_place.translation - center)};
  ASSERT_LT(ReprojectionError(map.problem, map.problem.Observation(idx), cam_from_shape, start),
            1e-6);
  const Sim3 place = RefineMarkerPlace(map.problem, truth, {idx}, start);
  EXPECT_LT(StepBetween(true_place, place).norm(), 1e-6);
}

}  // namespace
}  // namespace velamap
