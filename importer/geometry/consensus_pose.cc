#include "importer/geometry/consensus_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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
// not affect the search. Returns nothing for corners without extent.
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

// The markers of PoseConsensus, with errors in sides of the marker.
class MarkersInSpace {
 public:
  explicit MarkersInSpace(const std::vector<MarkerRays>& markers) : markers_(markers) {}

  std::size_t NumSampled() const { return markers_.size(); }
  std::size_t NumScored() const { return markers_.size(); }

  std::pair<Eigen::Vector3d, Eigen::Vector2d> Corner(std::size_t marker_idx,
                                                     std::size_t corner_idx) const {
    const MarkerRays& marker = markers_[marker_idx];
    return {marker.corners_in_space[corner_idx], marker.rays[corner_idx]};
  }

  std::vector<double> Errors(const Rigid3& cam_from_unit) const {
    const Eigen::Matrix3d rotation = cam_from_unit.rotation.toRotationMatrix();
    std::vector<double> errors;
    for (const MarkerRays& marker : markers_) {
      errors.push_back(ErrorInSides(marker, rotation, cam_from_unit.translation));
    }
    return errors;
  }

  // A pose that the markers do not support stays as it is.
  Rigid3 Fit(const std::vector<int>& inlier_idxs, const Rigid3& cam_from_unit) const {
    if (!Support(inlier_idxs)) return cam_from_unit;
    std::vector<RayObservation> observations;
    for (const int idx : inlier_idxs) {
      const MarkerRays& marker = markers_[static_cast<std::size_t>(idx)];
      for (std::size_t c = 0; c < kNumCorners; ++c) {
        observations.push_back({marker.corners_in_space[c], marker.rays[c]});
      }
    }
    return RefinePose(observations, cam_from_unit);
  }

  // At least four markers, and half of all.
  bool Support(const std::vector<int>& inlier_idxs) const {
    return inlier_idxs.size() >= kMinConsensus && 2 * inlier_idxs.size() >= markers_.size();
  }

 private:
  // The largest distance of a corner from its ray.
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

std::optional<PoseHypothesis> FindConsensusPose(std::vector<MarkerRays> markers) {
  if (markers.size() < kMinConsensus) return std::nullopt;
  const std::optional<UnitFrame> frame = CenterAndScale(&markers);
  if (!frame) return std::nullopt;
  const MarkersInSpace in_space(markers);
  const PoseConsensus<MarkersInSpace> consensus(in_space);
  std::vector<PoseHypothesis> hypotheses = Ransac({}, consensus);
  if (hypotheses.empty()) return std::nullopt;
  PoseHypothesis best = RefineHypothesis(consensus, kNumRounds, std::move(hypotheses.front()));
  if (!in_space.Support(best.inlier_idxs)) return std::nullopt;
  best.cam_from_space = CamFromSpace(best.cam_from_space, *frame);
  return best;
}

}  // namespace velamap
