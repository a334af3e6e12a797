#include "reconstruct/global/map_resection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "importer/geometry/pose_step.h"
#include "importer/geometry/triple_pose.h"
#include "reconstruct/global/map_refinement.h"

namespace velamap {
namespace {

// Few markers give hypotheses one by one; of many, triples of corners are far better.
constexpr std::size_t kMaxSingles = 12;
// By the share of markers that agree with the best pose so far; 50 are enough for a third of wrong
// markers.
constexpr int kMinTriples = 12, kMaxTriples = 50;
// Markers on which hypotheses are ranked before the best are refined on all.
constexpr std::size_t kMaxRanking = 24;
constexpr std::size_t kMaxRefined = 4;
constexpr std::size_t kMaxHypotheses = 3;
// Poses nearer than this are one: rotation, and translation as a part of the distance.
constexpr double kSameRotation = 0.08, kSameTranslation = 0.05;

struct KnownMarker {
  const MapObservation* observation;
  int observation_idx;
  const std::vector<Sim3>* places;
};

std::vector<KnownMarker> FindKnown(const MapProblem& problem, const MapSolution& solution,
                                   int frame_idx) {
  std::vector<KnownMarker> known;
  for (const int idx : problem.Frame(frame_idx).observation_idxs) {
    const MapObservation& observation = problem.Observation(idx);
    const auto& places =
        solution.shape_from_marker[static_cast<std::size_t>(observation.marker_idx)];
    if (!places.empty()) known.push_back({&observation, idx, &places});
  }
  return known;
}

// Scores the pose; where a marker has two places the better one counts.
PoseHypothesis Evaluate(const MapProblem& problem, const std::vector<KnownMarker>& known,
                        double tolerance_factor, const Rigid3& cam_from_shape,
                        std::vector<PlacedObservation>* agreeing = nullptr) {
  PoseHypothesis hypothesis{cam_from_shape, 0.0, {}};
  for (const KnownMarker& marker : known) {
    const Sim3* best_place = nullptr;
    double best_error_px = tolerance_factor * GrowthTolerance(*marker.observation);
    const double tolerance_px = best_error_px;
    for (const Sim3& place : *marker.places) {
      const double error_px =
          ReprojectionError(problem, *marker.observation, cam_from_shape, place);
      if (error_px > best_error_px) continue;
      best_error_px = error_px;
      best_place = &place;
    }
    hypothesis.cost += std::pow(best_error_px / tolerance_px, 2);
    if (best_place == nullptr) continue;
    hypothesis.observation_idxs.push_back(marker.observation_idx);
    if (agreeing != nullptr) agreeing->push_back({marker.observation, best_place});
  }
  return hypothesis;
}

// At most `max_count`, evenly over the list.
std::vector<KnownMarker> Thinned(const std::vector<KnownMarker>& known, std::size_t max_count) {
  if (known.size() <= max_count) return known;
  std::vector<KnownMarker> thinned;
  for (std::size_t i = 0; i < max_count; ++i)
    thinned.push_back(known[i * known.size() / max_count]);
  return thinned;
}

std::vector<Rigid3> SingleMarkerPoses(const std::vector<KnownMarker>& known) {
  std::vector<Rigid3> poses;
  for (const KnownMarker& marker : known) {
    for (const Rigid3& cam_from_marker : marker.observation->cam_from_marker) {
      for (const Sim3& place : *marker.places) {
        const Eigen::Quaterniond rotation = cam_from_marker.rotation * place.rotation.conjugate();
        poses.push_back({rotation.normalized(),
                         place.scale * cam_from_marker.translation - rotation * place.translation});
      }
    }
  }
  return poses;
}

// Poses that see a corner of each of three markers where they are; none for a marker drawn twice.
std::vector<Rigid3> TriplePoses(const MapProblem& problem, const std::vector<KnownMarker>& known,
                                std::mt19937* generator) {
  std::vector<Rigid3> poses;
  std::array<std::size_t, 3> idxs{};
  std::array<Eigen::Vector3d, 3> x_in_shape;
  std::array<Eigen::Vector2d, 3> rays;
  for (std::size_t i = 0; i < 3; ++i) {
    idxs[i] = RandomIndex(generator, known.size());
    const std::size_t corner = RandomIndex(generator, kNumCorners);
    const KnownMarker& marker = known[idxs[i]];
    x_in_shape[i] = marker.places->front() *
                    problem.Marker(marker.observation->marker_idx).corners_in_marker[corner];
    rays[i] = marker.observation->rays[corner];
  }
  if (idxs[0] == idxs[1] || idxs[1] == idxs[2] || idxs[0] == idxs[2]) return poses;
  for (const TriplePose& pose : PosesOfTriple(x_in_shape, rays)) {
    PoseStep step;
    step << pose.rotation_vector, pose.translation;
    poses.push_back(Moved({}, step));
  }
  return poses;
}

// All poses that single markers and triples give, ranked on some of the markers.
std::vector<PoseHypothesis> DrawHypotheses(const MapProblem& problem,
                                           const std::vector<KnownMarker>& known,
                                           const std::vector<KnownMarker>& ranking,
                                           double tolerance_factor, std::uint32_t random_seed) {
  std::vector<PoseHypothesis> hypotheses;
  std::size_t most_agreeing = 0;
  const auto add = [&](const std::vector<Rigid3>& poses) {
    for (const Rigid3& pose : poses) {
      hypotheses.push_back(Evaluate(problem, ranking, tolerance_factor, pose));
      most_agreeing = std::max(most_agreeing, hypotheses.back().observation_idxs.size());
    }
  };
  add(SingleMarkerPoses(Thinned(known, kMaxSingles)));
  // Where a marker has two places only one of them is drawn, so that the share says less.
  const bool is_clear = std::all_of(known.begin(), known.end(), [](const KnownMarker& marker) {
    return marker.places->size() == 1;
  });
  const auto is_enough = [&](int num_trials) {
    const double agreeing_part =
        static_cast<double>(most_agreeing) / static_cast<double>(ranking.size());
    return num_trials >=
           (is_clear ? NumTriples(agreeing_part, kMinTriples, kMaxTriples) : kMaxTriples);
  };
  std::mt19937 generator(random_seed);
  for (int trial = 0; known.size() >= 3 && !is_enough(trial); ++trial) {
    add(TriplePoses(problem, known, &generator));
  }
  return hypotheses;
}

bool IsSame(const Rigid3& a, const Rigid3& b) {
  return AngularDistance(a, b) < kSameRotation &&
         (a.translation - b.translation).norm() < kSameTranslation * a.translation.norm();
}

// Keeps the best of those that are nearly the same; ascending cost.
std::vector<PoseHypothesis> Distinct(std::vector<PoseHypothesis> hypotheses,
                                     std::size_t max_count) {
  std::stable_sort(
      hypotheses.begin(), hypotheses.end(),
      [](const PoseHypothesis& a, const PoseHypothesis& b) { return a.cost < b.cost; });
  std::vector<PoseHypothesis> distinct;
  for (PoseHypothesis& hypothesis : hypotheses) {
    if (distinct.size() == max_count) break;
    const bool is_new =
        std::none_of(distinct.begin(), distinct.end(), [&hypothesis](const PoseHypothesis& other) {
          return IsSame(other.cam_from_shape, hypothesis.cam_from_shape);
        });
    if (is_new) distinct.push_back(std::move(hypothesis));
  }
  return distinct;
}

PoseHypothesis Refine(const MapProblem& problem, const std::vector<KnownMarker>& known,
                      double tolerance_factor, PoseHypothesis hypothesis) {
  constexpr int kMaxRounds = 5;
  for (int round = 0; round < kMaxRounds; ++round) {
    std::vector<PlacedObservation> agreeing;
    Evaluate(problem, known, tolerance_factor, hypothesis.cam_from_shape, &agreeing);
    if (agreeing.empty()) break;
    PoseHypothesis refined =
        Evaluate(problem, known, tolerance_factor,
                 RefineFramePose(problem, agreeing, hypothesis.cam_from_shape));
    if (!(refined.cost < hypothesis.cost)) break;
    const bool is_settled = refined.observation_idxs == hypothesis.observation_idxs;
    hypothesis = std::move(refined);
    if (is_settled) break;
  }
  return hypothesis;
}

}  // namespace

std::vector<PoseHypothesis> ResectFrame(const MapProblem& problem, const MapSolution& solution,
                                        int frame_idx, double tolerance_factor,
                                        std::uint32_t random_seed) {
  const std::vector<KnownMarker> known = FindKnown(problem, solution, frame_idx);
  // Hypotheses are coarse, so they are ranked with a wider tolerance before they are refined.
  constexpr double kCoarse = 3.0;
  const std::vector<KnownMarker> ranking = Thinned(known, kMaxRanking);
  std::vector<PoseHypothesis> refined;
  for (PoseHypothesis& hypothesis :
       Distinct(DrawHypotheses(problem, known, ranking, kCoarse * tolerance_factor, random_seed),
                kMaxRefined)) {
    const Rigid3 coarse =
        Refine(problem, ranking, kCoarse * tolerance_factor, std::move(hypothesis)).cam_from_shape;
    refined.push_back(Refine(problem, known, tolerance_factor,
                             Evaluate(problem, known, tolerance_factor, coarse)));
  }
  return Distinct(std::move(refined), kMaxHypotheses);
}

bool IsAmbiguous(const std::vector<PoseHypothesis>& hypotheses) {
  // A hypothesis that explains as many observations, with errors within twice the best ones', is a
  // rival; the small constant spares the comparison of rounding errors.
  constexpr double kRatio = 2.0, kNegligible = 1e-3;
  if (hypotheses.size() < 2) return false;
  const PoseHypothesis &best = hypotheses[0], &rival = hypotheses[1];
  const double num_known = static_cast<double>(best.observation_idxs.size());
  return rival.cost < kRatio * best.cost + kNegligible * num_known &&
         rival.observation_idxs.size() >= best.observation_idxs.size();
}

}  // namespace velamap
