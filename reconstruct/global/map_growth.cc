#include "reconstruct/global/map_growth.h"

#include <algorithm>

#include "reconstruct/global/map_adjustment.h"
#include "reconstruct/global/map_intersection.h"
#include "reconstruct/global/map_resection.h"

namespace velamap {
namespace {

// Part of the known markers in a frame that has to agree with its pose.
constexpr double kMinInlierRatio = 0.4;
// Frames that see at least this part of what the best one sees of the map join in the same round.
constexpr double kJoinRatio = 0.5;
// Of so many frames the map is good enough to take all others that see it at once.
constexpr int kManyFrames = 16;

int NumFits(const MapProblem& problem, const MapSolution& solution, int marker_idx) {
  int count = 0;
  for (const int idx : problem.Marker(marker_idx).observation_idxs) {
    count += solution.fits[static_cast<std::size_t>(idx)];
  }
  return count;
}

bool IsRegistered(const MapSolution& solution, int frame_idx) {
  return solution.cam_from_shape[static_cast<std::size_t>(frame_idx)].has_value();
}

// Number of views on the markers that a frame sees and the map knows; two views at most count,
// which confirm a place.
int Knowledge(const MapProblem& problem, const MapSolution& solution,
              const std::vector<int>& num_fits, int frame_idx) {
  int knowledge = 0;
  for (const int idx : problem.Frame(frame_idx).observation_idxs) {
    const std::size_t marker_idx = static_cast<std::size_t>(problem.Observation(idx).marker_idx);
    if (solution.shape_from_marker[marker_idx].empty()) continue;
    knowledge += num_fits[marker_idx] >= 2 ? 2 : 1;
  }
  return knowledge;
}

int NumKnown(const MapProblem& problem, const MapSolution& solution, int frame_idx) {
  const auto& idxs = problem.Frame(frame_idx).observation_idxs;
  return static_cast<int>(std::count_if(idxs.begin(), idxs.end(), [&](int idx) {
    return !solution
                .shape_from_marker[static_cast<std::size_t>(problem.Observation(idx).marker_idx)]
                .empty();
  }));
}

struct Candidate {
  int frame_idx;
  int knowledge;
};

// Unregistered frames that see something of the map, those that see most first.
std::vector<Candidate> FindCandidates(const MapProblem& problem, const MapSolution& solution,
                                      const std::vector<int>& frame_idxs,
                                      const MapGrowthOptions& options) {
  std::vector<int> num_fits;
  for (std::size_t idx = 0; idx < problem.markers.size(); ++idx) {
    num_fits.push_back(NumFits(problem, solution, static_cast<int>(idx)));
  }
  std::vector<Candidate> candidates;
  for (const int frame_idx : frame_idxs) {
    if (IsRegistered(solution, frame_idx) ||
        NumKnown(problem, solution, frame_idx) < options.min_num_inliers) {
      continue;
    }
    candidates.push_back({frame_idx, Knowledge(problem, solution, num_fits, frame_idx)});
  }
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.knowledge > b.knowledge; });
  return candidates;
}

bool RegisterFrame(const MapProblem& problem, const MapGrowthOptions& options, int frame_idx,
                   double tolerance_factor, bool accept_ambiguous, MapSolution* solution) {
  const auto hypotheses =
      ResectFrame(problem, *solution, frame_idx, tolerance_factor, options.random_seed);
  if (hypotheses.empty() || (!accept_ambiguous && IsAmbiguous(hypotheses))) return false;
  const double num_inliers = static_cast<double>(hypotheses.front().observation_idxs.size());
  if (num_inliers < options.min_num_inliers ||
      num_inliers < kMinInlierRatio * NumKnown(problem, *solution, frame_idx)) {
    return false;
  }
  solution->cam_from_shape[static_cast<std::size_t>(frame_idx)] = hypotheses.front().cam_from_shape;
  return true;
}

// Registers a batch; returns the number of frames that joined.
int RegisterBatch(const MapProblem& problem, const std::vector<int>& frame_idxs,
                  const MapGrowthOptions& options, double tolerance_factor, bool accept_ambiguous,
                  MapSolution* solution) {
  const auto candidates = FindCandidates(problem, *solution, frame_idxs, options);
  const int num_registered = solution->NumRegistered();
  int room = num_registered < kManyFrames ? num_registered : static_cast<int>(candidates.size());
  if (options.max_num_frames > 0) room = std::min(room, options.max_num_frames - num_registered);
  int num_joined = 0;
  for (const Candidate& candidate : candidates) {
    if (num_joined >= room) break;
    if (num_joined > 0 && candidate.knowledge < kJoinRatio * candidates.front().knowledge) break;
    num_joined += RegisterFrame(problem, options, candidate.frame_idx, tolerance_factor,
                                accept_ambiguous, solution);
    // One of an ambiguous pair may settle the rest.
    if (accept_ambiguous && num_joined > 0) break;
  }
  return num_joined;
}

}  // namespace

void GrowMap(const MapProblem& problem, const std::vector<int>& frame_idxs,
             const MapGrowthOptions& options, MapSolution* solution) {
  // While few frames are in, the map is not precise.
  constexpr int kFewFrames = 6;
  constexpr double kSettledRatio = 0.6;
  const auto tolerance_factor = [solution] {
    return solution->NumRegistered() < kFewFrames ? 2.0 : 1.0;
  };
  PlaceUnsettledMarkers(problem, kSettledRatio, tolerance_factor(), solution);
  while (options.max_num_frames == 0 || solution->NumRegistered() < options.max_num_frames) {
    int num_joined = 0;
    for (const bool accept_ambiguous : {false, true}) {
      if (num_joined > 0) break;
      num_joined = RegisterBatch(problem, frame_idxs, options, tolerance_factor(), accept_ambiguous,
                                 solution);
    }
    if (num_joined == 0) break;
    MarkFits(problem, tolerance_factor(), solution);
    PlaceUnsettledMarkers(problem, kSettledRatio, tolerance_factor(), solution);
    if (!options.adjust) continue;
    AdjustMap(problem, {4, 1e-3}, solution);
    MarkFits(problem, tolerance_factor(), solution);
    PlaceUnsettledMarkers(problem, kSettledRatio, tolerance_factor(), solution);
  }
}

bool IsSettled(const MapProblem& problem, const MapSolution& solution, int marker_idx,
               double settled_ratio) {
  int num_seen = 0, num_fits = 0;
  for (const int idx : problem.Marker(marker_idx).observation_idxs) {
    if (!IsRegistered(solution, problem.Observation(idx).frame_idx)) continue;
    ++num_seen;
    num_fits += solution.fits[static_cast<std::size_t>(idx)];
  }
  return solution.shape_from_marker[static_cast<std::size_t>(marker_idx)].size() == 1 &&
         num_fits >= 2 && num_fits >= settled_ratio * num_seen;
}

void PlaceUnsettledMarkers(const MapProblem& problem, double settled_ratio, double tolerance_factor,
                           MapSolution* solution) {
  for (std::size_t idx = 0; idx < problem.markers.size(); ++idx) {
    const int marker_idx = static_cast<int>(idx);
    if (IsSettled(problem, *solution, marker_idx, settled_ratio)) continue;
    auto& places = solution->shape_from_marker[idx];
    places.clear();
    for (const PlaceHypothesis& place :
         PlaceMarker(problem, *solution, marker_idx, tolerance_factor).places) {
      places.push_back(place.shape_from_marker);
    }
  }
  MarkFits(problem, tolerance_factor, solution);
}

}  // namespace velamap
