#include "reconstruct/map/map_growth.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "importer/base/parallel.h"
#include "reconstruct/map/map_adjustment.h"
#include "reconstruct/map/map_intersection.h"
#include "reconstruct/map/map_resection.h"

namespace velamap {
namespace {

// Share of the known markers in a frame that must agree with its pose.
constexpr double kMinInlierRatio = 0.4;
// Frames join in the same round as the best frame if their markers have at least this fraction of
// the views that the best frame's markers have.
constexpr double kJoinRatio = 0.5;
// A map of fewer frames may at most double in a round.
constexpr int kManyFrames = 16;

// Number of views that the map has of the markers that a frame sees; at most two of each marker
// count, because two confirm its place.
int NumViewsOfSeen(const MapProblem& problem, const MapSolution& solution,
                   const std::vector<int>& num_inliers, int frame_idx) {
  int num_views = 0;
  for (const int idx : problem.Frame(frame_idx).observation_idxs) {
    const std::size_t marker_idx = static_cast<std::size_t>(problem.Observation(idx).marker_idx);
    if (solution.shape_from_marker[marker_idx].empty()) continue;
    num_views += num_inliers[marker_idx] >= 2 ? 2 : 1;
  }
  return num_views;
}

struct Candidate {
  int frame_idx;
  int num_views;
};

// Unregistered frames that see part of the map, those that see most first.
std::vector<Candidate> FindCandidates(const MapProblem& problem, const MapSolution& solution,
                                      const std::vector<int>& frame_idxs,
                                      const MapGrowthOptions& options) {
  std::vector<int> num_inliers;
  for (std::size_t idx = 0; idx < problem.markers.size(); ++idx) {
    num_inliers.push_back(NumInliers(problem, solution, static_cast<int>(idx)));
  }
  std::vector<Candidate> candidates;
  for (const int frame_idx : frame_idxs) {
    if (solution.Pose(frame_idx) ||
        NumKnown(problem, solution, frame_idx) < options.min_num_inliers) {
      continue;
    }
    candidates.push_back({frame_idx, NumViewsOfSeen(problem, solution, num_inliers, frame_idx)});
  }
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.num_views > b.num_views; });
  return candidates;
}

// The pose at which a frame joins the map. Returns nothing if too few markers support one, or if
// two poses explain the frame.
std::optional<Rigid3> FindPose(const MapProblem& problem, const MapSolution& solution,
                               const MapGrowthOptions& options, int frame_idx,
                               double tolerance_factor, bool accept_ambiguous) {
  const auto hypotheses =
      ResectFrame(problem, solution, frame_idx, tolerance_factor, options.random_seed);
  if (hypotheses.empty() || (!accept_ambiguous && IsAmbiguous(hypotheses))) return std::nullopt;
  const double num_inliers = static_cast<double>(hypotheses.front().inlier_idxs.size());
  if (num_inliers < options.min_num_inliers ||
      num_inliers < kMinInlierRatio * NumKnown(problem, solution, frame_idx)) {
    return std::nullopt;
  }
  return hypotheses.front().cam_from_space;
}

// Registers a batch; returns the number of frames that joined. A frame's pose depends only on the
// places of markers, so poses are computed in parallel.
int RegisterBatch(const MapProblem& problem, const std::vector<int>& frame_idxs,
                  const MapGrowthOptions& options, double tolerance_factor, bool accept_ambiguous,
                  MapSolution* solution) {
  const auto candidates = FindCandidates(problem, *solution, frame_idxs, options);
  const int num_registered = solution->NumRegistered();
  int max_num_joining =
      num_registered < kManyFrames ? num_registered : static_cast<int>(candidates.size());
  if (options.max_num_frames > 0) {
    max_num_joining = std::min(max_num_joining, options.max_num_frames - num_registered);
  }
  const std::size_t num_at_once = static_cast<std::size_t>(NumThreads(options.num_threads));
  std::vector<std::optional<Rigid3>> poses(candidates.size());
  int num_joined = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (num_joined >= max_num_joining) break;
    if (num_joined > 0 && candidates[i].num_views < kJoinRatio * candidates.front().num_views) {
      break;
    }
    if (i % num_at_once == 0) {
      ParallelFor(
          std::min(num_at_once, candidates.size() - i), options.num_threads, [&](std::size_t k) {
            poses[i + k] = FindPose(problem, *solution, options, candidates[i + k].frame_idx,
                                    tolerance_factor, accept_ambiguous);
          });
    }
    if (!poses[i]) continue;
    solution->cam_from_shape[static_cast<std::size_t>(candidates[i].frame_idx)] = poses[i];
    ++num_joined;
    // A frame that has joined may resolve the other ambiguous ones.
    if (accept_ambiguous) break;
  }
  return num_joined;
}

}  // namespace

void GrowMap(const MapProblem& problem, const std::vector<int>& frame_idxs,
             const MapGrowthOptions& options, MapSolution* solution) {
  // The map is not precise while it has few frames.
  constexpr int kFewFrames = 6;
  constexpr double kSettledRatio = 0.6;
  // Rough, because the next round moves everything again.
  constexpr MapAdjustmentOptions kBetweenRounds{4, 1e-3};
  const auto tolerance_factor = [solution] {
    return solution->NumRegistered() < kFewFrames ? 2.0 : 1.0;
  };
  PlaceUnsettledMarkers(problem, kSettledRatio, tolerance_factor(), options.num_threads, solution);
  while (options.max_num_frames == 0 || solution->NumRegistered() < options.max_num_frames) {
    int num_joined = 0;
    for (const bool accept_ambiguous : {false, true}) {
      if (num_joined > 0) break;
      num_joined = RegisterBatch(problem, frame_idxs, options, tolerance_factor(), accept_ambiguous,
                                 solution);
    }
    if (num_joined == 0) break;
    MarkInliers(problem, tolerance_factor(), solution);
    PlaceUnsettledMarkers(problem, kSettledRatio, tolerance_factor(), options.num_threads,
                          solution);
    if (!options.adjust) continue;
    AdjustMap(problem, kBetweenRounds, solution);
    MarkInliers(problem, tolerance_factor(), solution);
    PlaceUnsettledMarkers(problem, kSettledRatio, tolerance_factor(), options.num_threads,
                          solution);
  }
}

bool IsSettled(const MapProblem& problem, const MapSolution& solution, int marker_idx,
               double settled_ratio) {
  int num_seen = 0, num_inliers = 0;
  for (const int idx : problem.Marker(marker_idx).observation_idxs) {
    if (!solution.Pose(problem.Observation(idx).frame_idx)) continue;
    ++num_seen;
    num_inliers += solution.IsInlier(idx);
  }
  return solution.Places(marker_idx).size() == 1 && num_inliers >= 2 &&
         num_inliers >= settled_ratio * num_seen;
}

void PlaceUnsettledMarkers(const MapProblem& problem, double settled_ratio, double tolerance_factor,
                           int num_threads, MapSolution* solution) {
  std::vector<std::vector<Sim3>> places = solution->shape_from_marker;
  ParallelFor(problem.markers.size(), num_threads, [&](std::size_t idx) {
    const int marker_idx = static_cast<int>(idx);
    if (IsSettled(problem, *solution, marker_idx, settled_ratio)) return;
    places[idx] = PlaceMarker(problem, *solution, marker_idx, tolerance_factor).ShapeFromMarker();
  });
  solution->shape_from_marker = std::move(places);
  MarkInliers(problem, tolerance_factor, solution);
}

}  // namespace velamap
