#include "reconstruct/map/map_resection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "importer/base/statistics.h"
#include "importer/geometry/p3p.h"
#include "importer/geometry/ransac.h"
#include "reconstruct/map/map_refinement.h"

namespace velamap {
namespace {

// Single markers supply hypotheses where there are few; where there are many, triples of corners
// are far better.
constexpr std::size_t kMaxSingles = 12;
// 50 samples are enough where a third of the markers is wrong.
constexpr int kMinTriples = 12, kMaxTriples = 50;
// Number of markers on which hypotheses are ranked; the best are refined on all.
constexpr std::size_t kMaxRanking = 24;
constexpr std::size_t kMaxRefined = 4;
constexpr std::size_t kMaxHypotheses = 3;
// Poses nearer than this count as one: rotation in rad, translation relative to the distance.
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
    const auto& places = solution.Places(observation.marker_idx);
    if (!places.empty()) known.push_back({&observation, idx, &places});
  }
  return known;
}

// Scores the pose. Where a marker has two places, the better one counts.
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

// See ransac.h. Scores hypotheses on `ranking`, which may be a part of the markers `known`.
class FrameConsensus {
 public:
  using Model = Rigid3;
  using Hypothesis = PoseHypothesis;
  static constexpr int kSampleSize = 3;

  FrameConsensus(const MapProblem& problem, const std::vector<KnownMarker>& known,
                 const std::vector<KnownMarker>& ranking, double tolerance_factor)
      : problem_(problem), known_(known), ranking_(ranking), tolerance_factor_(tolerance_factor) {}

  // Poses that fit one corner of each of three markers exactly.
  std::vector<Rigid3> Generate(std::mt19937* generator) const {
    const auto sample = SampleCorners(known_.size(), generator);
    if (!sample) return {};
    std::array<Eigen::Vector3d, 3> x_in_shape;
    std::array<Eigen::Vector2d, 3> rays;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [marker_idx, corner_idx] = (*sample)[i];
      const KnownMarker& marker = known_[marker_idx];
      x_in_shape[i] = marker.places->front() *
                      problem_.Marker(marker.observation->marker_idx).corners_in_marker[corner_idx];
      rays[i] = marker.observation->rays[corner_idx];
    }
    return SolveP3P(x_in_shape, rays);
  }

  PoseHypothesis Score(const Rigid3& cam_from_shape) const {
    return Evaluate(problem_, ranking_, tolerance_factor_, cam_from_shape);
  }

  double InlierRatio(const PoseHypothesis& hypothesis) const {
    return static_cast<double>(hypothesis.observation_idxs.size()) /
           static_cast<double>(ranking_.size());
  }

  PoseHypothesis Refine(const PoseHypothesis& hypothesis) const {
    std::vector<PlacedObservation> agreeing;
    Evaluate(problem_, ranking_, tolerance_factor_, hypothesis.cam_from_shape, &agreeing);
    if (agreeing.empty()) return hypothesis;
    return Score(RefineFramePose(problem_, agreeing, hypothesis.cam_from_shape));
  }

  bool HasSameInliers(const PoseHypothesis& a, const PoseHypothesis& b) const {
    return a.observation_idxs == b.observation_idxs;
  }

 private:
  const MapProblem& problem_;
  const std::vector<KnownMarker>& known_;
  const std::vector<KnownMarker>& ranking_;
  const double tolerance_factor_;
};

RansacOptions SamplingOptions(const std::vector<KnownMarker>& known, std::uint32_t random_seed) {
  RansacOptions options{kMinTriples, kMaxTriples, random_seed};
  // Where a marker has two places, samples use one of them only, and the inlier ratio says less
  // about the number of samples needed.
  const bool is_clear = std::all_of(known.begin(), known.end(), [](const KnownMarker& marker) {
    return marker.places->size() == 1;
  });
  if (!is_clear) options.min_num_samples = kMaxTriples;
  if (known.size() < 3) options.max_num_samples = 0;
  return options;
}

bool IsSamePose(const PoseHypothesis& a, const PoseHypothesis& b) {
  const Rigid3 &pose_a = a.cam_from_shape, &pose_b = b.cam_from_shape;
  return AngularDistance(pose_a, pose_b) < kSameRotation &&
         (pose_a.translation - pose_b.translation).norm() <
             kSameTranslation * pose_a.translation.norm();
}

}  // namespace

std::vector<PoseHypothesis> ResectFrame(const MapProblem& problem, const MapSolution& solution,
                                        int frame_idx, double tolerance_factor,
                                        std::uint32_t random_seed) {
  const std::vector<KnownMarker> known = FindKnown(problem, solution, frame_idx);
  // Hypotheses are coarse, so they are ranked with a wider tolerance before they are refined.
  constexpr double kCoarse = 3.0;
  constexpr int kMaxRounds = 5;
  const std::vector<KnownMarker> ranking = Thinned(known, kMaxRanking);
  const FrameConsensus coarse(problem, known, ranking, kCoarse * tolerance_factor);
  const FrameConsensus fine(problem, known, known, tolerance_factor);
  std::vector<PoseHypothesis> refined;
  for (PoseHypothesis& hypothesis :
       DistinctHypotheses(Ransac(SamplingOptions(known, random_seed), coarse,
                                 SingleMarkerPoses(Thinned(known, kMaxSingles))),
                          IsSamePose, kMaxRefined)) {
    const Rigid3 cam_from_shape =
        RefineHypothesis(coarse, kMaxRounds, std::move(hypothesis)).cam_from_shape;
    refined.push_back(RefineHypothesis(fine, kMaxRounds, fine.Score(cam_from_shape)));
  }
  return DistinctHypotheses(std::move(refined), IsSamePose, kMaxHypotheses);
}

}  // namespace velamap
