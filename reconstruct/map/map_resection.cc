#include "reconstruct/map/map_resection.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "importer/base/statistics.h"
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

// The known markers of a frame for PoseConsensus. Errors are in tolerances; where a marker has two
// places, the better one counts.
class FrameMarkers {
 public:
  FrameMarkers(const MapProblem& problem, const std::vector<KnownMarker>& sampled,
               const std::vector<KnownMarker>& scored, double tolerance_factor)
      : problem_(problem),
        sampled_(sampled),
        scored_(scored),
        tolerance_factor_(tolerance_factor) {}

  std::size_t NumSampled() const { return sampled_.size(); }
  std::size_t NumScored() const { return scored_.size(); }

  std::pair<Eigen::Vector3d, Eigen::Vector2d> Corner(std::size_t marker_idx,
                                                     std::size_t corner_idx) const {
    const auto& [observation, observation_idx, places] = sampled_[marker_idx];
    return {
        places->front() * problem_.Marker(observation->marker_idx).corners_in_marker[corner_idx],
        observation->rays[corner_idx]};
  }

  std::vector<double> Errors(const Rigid3& cam_from_shape) const {
    std::vector<double> errors;
    for (const KnownMarker& marker : scored_) {
      errors.push_back(BestPlace(marker, cam_from_shape).error_px /
                       (tolerance_factor_ * GrowthTolerance(*marker.observation)));
    }
    return errors;
  }

  Rigid3 Fit(const std::vector<int>& inlier_idxs, const Rigid3& cam_from_shape) const {
    std::vector<PlacedObservation> placed;
    for (const int idx : inlier_idxs) {
      const KnownMarker& marker = scored_[static_cast<std::size_t>(idx)];
      placed.push_back({marker.observation, BestPlace(marker, cam_from_shape).place});
    }
    return RefineFramePose(problem_, placed, cam_from_shape);
  }

 private:
  struct PlaceError {
    const Sim3* place;
    double error_px;
  };

  PlaceError BestPlace(const KnownMarker& marker, const Rigid3& cam_from_shape) const {
    PlaceError best{nullptr, std::numeric_limits<double>::infinity()};
    for (const Sim3& place : *marker.places) {
      const double error_px =
          ReprojectionError(problem_, *marker.observation, cam_from_shape, place);
      if (error_px <= best.error_px) best = {&place, error_px};
    }
    return best;
  }

  const MapProblem& problem_;
  const std::vector<KnownMarker>& sampled_;
  const std::vector<KnownMarker>& scored_;
  const double tolerance_factor_;
};

RansacOptions SamplingOptions(const std::vector<KnownMarker>& known, std::uint32_t random_seed) {
  RansacOptions options{kMinTriples, kMaxTriples, random_seed};
  // If a marker has two places, samples use one of them only, and the inlier ratio says less
  // about the number of samples needed.
  const bool is_clear = std::all_of(known.begin(), known.end(), [](const KnownMarker& marker) {
    return marker.places->size() == 1;
  });
  if (!is_clear) options.min_num_samples = kMaxTriples;
  if (known.size() < 3) options.max_num_samples = 0;
  return options;
}

bool IsSamePose(const PoseHypothesis& a, const PoseHypothesis& b) {
  const Rigid3 &pose_a = a.cam_from_space, &pose_b = b.cam_from_space;
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
  const FrameMarkers coarse_markers(problem, known, ranking, kCoarse * tolerance_factor);
  const FrameMarkers fine_markers(problem, known, known, tolerance_factor);
  const PoseConsensus<FrameMarkers> coarse(coarse_markers), fine(fine_markers);
  std::vector<PoseHypothesis> refined;
  for (PoseHypothesis& hypothesis :
       DistinctHypotheses(Ransac(SamplingOptions(known, random_seed), coarse,
                                 SingleMarkerPoses(Thinned(known, kMaxSingles))),
                          IsSamePose, kMaxRefined)) {
    const Rigid3 cam_from_shape =
        RefineHypothesis(coarse, kMaxRounds, std::move(hypothesis)).cam_from_space;
    refined.push_back(RefineHypothesis(fine, kMaxRounds, fine.Score(cam_from_shape)));
  }
  refined = DistinctHypotheses(std::move(refined), IsSamePose, kMaxHypotheses);
  for (PoseHypothesis& hypothesis : refined) {
    for (int& idx : hypothesis.inlier_idxs) {
      idx = known[static_cast<std::size_t>(idx)].observation_idx;
    }
  }
  return refined;
}

}  // namespace velamap
