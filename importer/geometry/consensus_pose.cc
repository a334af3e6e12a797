#include "importer/geometry/consensus_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "importer/geometry/p3p.h"
#include "importer/geometry/pose_refinement.h"
#include "importer/geometry/ransac.h"

namespace velamap {
namespace {

// Fits to the markers that agree; each may bring more of them to agree.
constexpr int kNumRounds = 2;

// x_in_unit = scale * (x_in_space - center_in_space)
struct UnitFrame {
  Eigen::Vector3d center_in_space = Eigen::Vector3d::Zero();
  double scale = 1.0;
};

// Brings all corners to mean 0 and RMS distance 1, so that the frame and the unit of the space do
// not affect the search. Nothing for corners without extent.
std::optional<UnitFrame> CenterAndScale(std::vector<MarkerRays>* markers) {
  UnitFrame frame;
  const double num_corners = static_cast<double>(kNumCorners * markers->size());
  for (const MarkerRays& marker : *markers) {
    for (const Eigen::Vector3d& x : marker.corners_in_space) {
      frame.center_in_space += x / num_corners;
    }
  }
  double squared_radius = 0.0;
  for (const MarkerRays& marker : *markers) {
    for (const Eigen::Vector3d& x : marker.corners_in_space) {
      squared_radius += (x - frame.center_in_space).squaredNorm() / num_corners;
    }
  }
  frame.scale = 1.0 / std::sqrt(squared_radius);
  if (!(frame.scale > 0) || !std::isfinite(frame.scale)) return std::nullopt;
  for (MarkerRays& marker : *markers) {
    for (Eigen::Vector3d& x : marker.corners_in_space) {
      x = frame.scale * (x - frame.center_in_space);
    }
  }
  return frame;
}

Rigid3 CamFromSpace(const Rigid3& cam_from_unit, const UnitFrame& frame) {
  return {cam_from_unit.rotation,
          cam_from_unit.translation / frame.scale - cam_from_unit.rotation * frame.center_in_space};
}

struct ConsensusHypothesis {
  Rigid3 cam_from_unit;
  double cost = 0.0;  // truncated sum of squared errors, in sides
  std::vector<std::size_t> agreeing_idxs;
};

// See ransac.h.
class MarkerConsensus {
 public:
  using Model = Rigid3;
  using Hypothesis = ConsensusHypothesis;
  static constexpr int kSampleSize = 3;

  explicit MarkerConsensus(const std::vector<MarkerRays>& markers) : markers_(markers) {}

  std::vector<Rigid3> Generate(std::mt19937* generator) const {
    const auto sample = SampleCorners(markers_.size(), generator);
    if (!sample) return {};
    std::array<Eigen::Vector3d, 3> x_in_unit;
    std::array<Eigen::Vector2d, 3> rays;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [marker_idx, corner_idx] = (*sample)[i];
      x_in_unit[i] = markers_[marker_idx].corners_in_space[corner_idx];
      rays[i] = markers_[marker_idx].rays[corner_idx];
    }
    return SolveP3P(x_in_unit, rays);
  }

  ConsensusHypothesis Score(const Rigid3& cam_from_unit) const {
    ConsensusHypothesis hypothesis{cam_from_unit, 0.0, {}};
    const Eigen::Matrix3d rotation = cam_from_unit.rotation.toRotationMatrix();
    for (std::size_t i = 0; i < markers_.size(); ++i) {
      const double error = ErrorInSides(markers_[i], rotation, cam_from_unit.translation);
      hypothesis.cost += error < 1.0 ? error * error : 1.0;
      if (error < 1.0) hypothesis.agreeing_idxs.push_back(i);
    }
    return hypothesis;
  }

  double InlierRatio(const ConsensusHypothesis& hypothesis) const {
    return static_cast<double>(hypothesis.agreeing_idxs.size()) /
           static_cast<double>(markers_.size());
  }

  ConsensusHypothesis Refine(const ConsensusHypothesis& hypothesis) const {
    if (!IsSupported(hypothesis)) return hypothesis;
    std::vector<RayObservation> observations;
    for (const std::size_t i : hypothesis.agreeing_idxs) {
      for (std::size_t c = 0; c < kNumCorners; ++c) {
        observations.push_back({markers_[i].corners_in_space[c], markers_[i].rays[c]});
      }
    }
    return Score(RefinePose(observations, hypothesis.cam_from_unit));
  }

  bool HasSameInliers(const ConsensusHypothesis& a, const ConsensusHypothesis& b) const {
    return a.agreeing_idxs == b.agreeing_idxs;
  }

  // At least four markers, and half of all.
  bool IsSupported(const ConsensusHypothesis& hypothesis) const {
    const std::size_t num_agreeing = hypothesis.agreeing_idxs.size();
    return num_agreeing >= kMinConsensus && 2 * num_agreeing >= markers_.size();
  }

 private:
  // The largest distance of a corner from its ray, in sides of the marker.
  static double ErrorInSides(const MarkerRays& marker, const Eigen::Matrix3d& rotation,
                             const Eigen::Vector3d& translation) {
    double max_error = 0.0;
    for (std::size_t c = 0; c < kNumCorners; ++c) {
      const Eigen::Vector3d x_in_cam = rotation * marker.corners_in_space[c] + translation;
      if (!(x_in_cam.z() > 0)) return std::numeric_limits<double>::infinity();
      max_error = std::max(max_error, (x_in_cam.hnormalized() - marker.rays[c]).norm());
    }
    return max_error / QuadMeanSide(marker.rays);
  }

  const std::vector<MarkerRays>& markers_;
};

}  // namespace

std::optional<ConsensusPose> FindConsensusPose(std::vector<MarkerRays> markers) {
  if (markers.size() < kMinConsensus) return std::nullopt;
  const std::optional<UnitFrame> frame = CenterAndScale(&markers);
  if (!frame) return std::nullopt;
  const MarkerConsensus consensus(markers);
  std::vector<ConsensusHypothesis> hypotheses = Ransac({}, consensus);
  if (hypotheses.empty()) return std::nullopt;
  const ConsensusHypothesis best =
      RefineHypothesis(consensus, kNumRounds, std::move(hypotheses.front()));
  if (!consensus.IsSupported(best)) return std::nullopt;
  return ConsensusPose{CamFromSpace(best.cam_from_unit, *frame), best.agreeing_idxs};
}

}  // namespace velamap
