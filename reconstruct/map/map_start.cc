#include "reconstruct/map/map_start.h"

#include <algorithm>
#include <set>

#include <Eigen/Geometry>

#include "importer/base/statistics.h"
#include "importer/geometry/directions.h"
#include "importer/geometry/principal_axes.h"
#include "importer/geometry/units.h"
#include "reconstruct/map/map_adjustment.h"
#include "reconstruct/map/map_intersection.h"
#include "reconstruct/map/map_resection.h"

namespace velamap {
namespace {

constexpr double kFullParallax = 20 * kRadPerDeg;

// Angle between the directions from which two frames see a marker, rad; the smallest over the
// combinations of their planar solutions.
double Parallax(const MapObservation& a, const MapObservation& b) {
  double smallest = kPi;
  for (const Rigid3& a_from_marker : a.cam_from_marker) {
    for (const Rigid3& b_from_marker : b.cam_from_marker) {
      smallest = std::min(smallest, AngleBetween(Inverse(a_from_marker).translation,
                                                 Inverse(b_from_marker).translation));
    }
  }
  return smallest;
}

double PairScore(const MapProblem& problem, int frame_idx1, int frame_idx2, int min_num_shared) {
  const auto &idxs1 = problem.Frame(frame_idx1).observation_idxs,
             &idxs2 = problem.Frame(frame_idx2).observation_idxs;
  std::vector<double> parallaxes;
  auto in_1 = idxs1.begin(), in_2 = idxs2.begin();
  while (in_1 != idxs1.end() && in_2 != idxs2.end()) {
    const MapObservation &a = problem.Observation(*in_1), &b = problem.Observation(*in_2);
    if (a.marker_idx == b.marker_idx) parallaxes.push_back(Parallax(a, b));
    const bool advance_1 = a.marker_idx <= b.marker_idx, advance_2 = b.marker_idx <= a.marker_idx;
    in_1 += advance_1;
    in_2 += advance_2;
  }
  if (static_cast<int>(parallaxes.size()) < min_num_shared) return 0.0;
  const double num_shared = static_cast<double>(parallaxes.size());
  // A pair without parallax scores a little, because a poor start is better than none.
  return num_shared * (0.01 + std::min(1.0, Median(std::move(parallaxes)) / kFullParallax));
}

// Places and adjusts the markers that both frames see, then again without the outliers.
void SettlePair(const MapProblem& problem, const std::set<int>& marker_idxs,
                MapSolution* solution) {
  for (const double tolerance_factor : {3.0, 1.0}) {
    for (const int marker_idx : marker_idxs) {
      solution->shape_from_marker[static_cast<std::size_t>(marker_idx)] =
          PlaceMarker(problem, *solution, marker_idx, tolerance_factor).ShapeFromMarker();
    }
    MarkInliers(problem, tolerance_factor, solution);
    AdjustMap(problem, {15, 1e-4}, solution);
  }
  MarkInliers(problem, 1.0, solution);
}

}  // namespace

std::vector<std::pair<int, int>> ChooseStartPairs(const MapProblem& problem,
                                                  const std::vector<int>& frame_idxs,
                                                  int max_num_pairs, int min_num_shared) {
  struct ScoredPair {
    double score;
    std::pair<int, int> pair;
  };
  std::vector<ScoredPair> scored;
  for (std::size_t i = 0; i < frame_idxs.size(); ++i) {
    for (std::size_t j = i + 1; j < frame_idxs.size(); ++j) {
      const double score = PairScore(problem, frame_idxs[i], frame_idxs[j], min_num_shared);
      if (score > 0) scored.push_back({score, {frame_idxs[i], frame_idxs[j]}});
    }
  }
  std::stable_sort(scored.begin(), scored.end(),
                   [](const ScoredPair& a, const ScoredPair& b) { return a.score > b.score; });
  std::vector<std::pair<int, int>> chosen;
  std::set<int> used;
  for (const ScoredPair& candidate : scored) {
    if (static_cast<int>(chosen.size()) == max_num_pairs) break;
    const auto [a, b] = candidate.pair;
    if (used.count(a) > 0 || used.count(b) > 0) continue;
    used.insert({a, b});
    chosen.push_back(candidate.pair);
  }
  return chosen;
}

MapSolution StartFromPair(const MapProblem& problem, const std::pair<int, int>& pair,
                          std::uint32_t random_seed) {
  // Depths from the first frame alone are poor.
  constexpr double kToleranceOfOneFrame = 4.0;
  const auto [first, second] = pair;
  MapSolution from_first = EmptySolution(problem);
  from_first.cam_from_shape[static_cast<std::size_t>(first)] = Rigid3{};
  for (const int idx : problem.Frame(first).observation_idxs) {
    const MapObservation& observation = problem.Observation(idx);
    for (const Rigid3& cam_from_marker : observation.cam_from_marker) {
      from_first.shape_from_marker[static_cast<std::size_t>(observation.marker_idx)].push_back(
          {1.0, cam_from_marker.rotation, cam_from_marker.translation});
    }
  }
  std::set<int> in_both;
  for (const int idx : problem.Frame(second).observation_idxs) {
    const int marker_idx = problem.Observation(idx).marker_idx;
    if (!from_first.Places(marker_idx).empty()) in_both.insert(marker_idx);
  }
  MapSolution best = EmptySolution(problem);
  double most_explained = 0.0;
  const auto keep_better = [&](const MapSolution& solution) {
    const double explained = ExplainedObservations(problem, solution);
    if (explained <= most_explained) return;
    most_explained = explained;
    best = solution;
  };
  for (const PoseHypothesis& hypothesis :
       ResectFrame(problem, from_first, second, kToleranceOfOneFrame, random_seed)) {
    MapSolution solution = EmptySolution(problem);
    solution.cam_from_shape[static_cast<std::size_t>(first)] = Rigid3{};
    solution.cam_from_shape[static_cast<std::size_t>(second)] = hypothesis.cam_from_space;
    SettlePair(problem, in_both, &solution);
    keep_better(solution);
    MapSolution reversed = ReversedRelief(solution);
    MarkInliers(problem, kToleranceOfOneFrame, &reversed);
    AdjustMap(problem, {15, 1e-4}, &reversed);
    SettlePair(problem, in_both, &reversed);
    keep_better(reversed);
  }
  return best;
}

double ExplainedObservations(const MapProblem& problem, const MapSolution& solution) {
  constexpr double kSigmas = 6.0, kFractionOfTolerance = 0.5;
  double explained = 0.0;
  for (const MapObservation& observation : problem.observations) {
    const double tolerance_px = std::max(kSigmas * observation.sigma_px,
                                         kFractionOfTolerance * GrowthTolerance(observation));
    const double relative = ReprojectionError(problem, solution, observation) / tolerance_px;
    explained += std::max(0.0, 1 - relative * relative);
  }
  return explained;
}

MapSolution ReversedRelief(const MapSolution& solution) {
  std::vector<Eigen::Vector3d> centers;
  for (const auto& places : solution.shape_from_marker) {
    if (!places.empty()) centers.push_back(places.front().translation);
  }
  if (centers.empty()) return solution;
  const PrincipalAxes axes = ComputePrincipalAxes(centers);
  const Eigen::Vector3d center = axes.mean, normal = axes.directions.col(0);
  const Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity() - 2 * normal * normal.transpose();
  const Eigen::DiagonalMatrix<double, 3> flip(1, 1, -1);
  MapSolution reversed = solution;
  for (auto& pose : reversed.cam_from_shape) {
    if (!pose) continue;
    const Eigen::Vector3d center_in_cam = *pose * center;
    pose->rotation =
        Eigen::Quaterniond(Eigen::Matrix3d(flip * pose->rotation.toRotationMatrix() * mirror))
            .normalized();
    pose->translation = center_in_cam - pose->rotation * center;
  }
  for (auto& places : reversed.shape_from_marker) {
    for (Sim3& place : places) {
      place.rotation =
          Eigen::Quaterniond(Eigen::Matrix3d(mirror * place.rotation.toRotationMatrix() * flip))
              .normalized();
      place.translation = center + mirror * (place.translation - center);
    }
  }
  return reversed;
}

}  // namespace velamap
