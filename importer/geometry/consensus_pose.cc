#include "importer/geometry/consensus_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <opencv2/calib3d.hpp>

#include "importer/geometry/triple_pose.h"

namespace velamap {
namespace {

// Of adjustments to those that agree, each of which may make some more agree.
constexpr int kNumRounds = 2;

// 160 are enough for half of the markers wrong.
constexpr int kMinDraws = 12, kMaxDraws = 160;
constexpr unsigned int kRandomSeed = 0;

// x_in_unit = scale * (x_in_space - center_in_space)
struct UnitFrame {
  Eigen::Vector3d center_in_space = Eigen::Vector3d::Zero();
  double scale = 1.0;
};

// Brings all corners to mean 0 and RMS distance 1, so that neither frame nor unit of the space
// matters to what follows. Nothing for corners without extent.
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

Eigen::Isometry3d CamFromSpace(const Eigen::Isometry3d& cam_from_unit, const UnitFrame& frame) {
  Eigen::Isometry3d cam_from_space = cam_from_unit;
  cam_from_space.translation() =
      cam_from_unit.translation() / frame.scale - cam_from_unit.linear() * frame.center_in_space;
  return cam_from_space;
}

// Of the marker's corner that is farthest from its place, in sides of the marker.
double ErrorInSides(const MarkerRays& marker, const Eigen::Isometry3d& cam_from_unit) {
  double max_error = 0.0;
  for (std::size_t c = 0; c < kNumCorners; ++c) {
    const Eigen::Vector3d x_in_cam = cam_from_unit * marker.corners_in_space[c];
    if (!(x_in_cam.z() > 0)) return std::numeric_limits<double>::infinity();
    max_error = std::max(max_error, (x_in_cam.hnormalized() - marker.rays[c]).norm());
  }
  return max_error / QuadMeanSide(marker.rays);
}

std::vector<std::size_t> Agreeing(const std::vector<MarkerRays>& markers,
                                  const Eigen::Isometry3d& cam_from_unit) {
  std::vector<std::size_t> idxs;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (ErrorInSides(markers[i], cam_from_unit) < 1.0) idxs.push_back(i);
  }
  return idxs;
}

Eigen::Isometry3d ToIsometry(const Eigen::Vector3d& rotation_vector,
                             const Eigen::Vector3d& translation) {
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  const double angle = rotation_vector.norm();
  if (angle > 0) isometry.linear() = Eigen::AngleAxisd(angle, rotation_vector / angle).matrix();
  isometry.translation() = translation;
  return isometry;
}

// Poses that see one corner of each of three markers where it is; none for a marker drawn twice.
std::vector<Eigen::Isometry3d> DrawPoses(const std::vector<MarkerRays>& markers,
                                         std::mt19937* generator) {
  std::vector<Eigen::Isometry3d> poses;
  std::array<std::size_t, 3> idxs{};
  std::array<Eigen::Vector3d, 3> x_in_unit;
  std::array<Eigen::Vector2d, 3> rays;
  for (std::size_t i = 0; i < 3; ++i) {
    idxs[i] = RandomIndex(generator, markers.size());
    const std::size_t corner = RandomIndex(generator, kNumCorners);
    x_in_unit[i] = markers[idxs[i]].corners_in_space[corner];
    rays[i] = markers[idxs[i]].rays[corner];
  }
  if (idxs[0] == idxs[1] || idxs[1] == idxs[2] || idxs[0] == idxs[2]) return poses;
  for (const TriplePose& pose : PosesOfTriple(x_in_unit, rays)) {
    poses.push_back(ToIsometry(pose.rotation_vector, pose.translation));
  }
  return poses;
}

// The drawn pose with the least sum of squared errors, those of a side and more alike.
Eigen::Isometry3d FindConsensus(const std::vector<MarkerRays>& markers) {
  Eigen::Isometry3d best_pose = Eigen::Isometry3d::Identity();
  double least_cost = std::numeric_limits<double>::infinity();
  double agreeing_part = 0.0;
  std::mt19937 generator(kRandomSeed);
  for (int draw = 0; draw < NumTriples(agreeing_part, kMinDraws, kMaxDraws); ++draw) {
    for (const Eigen::Isometry3d& pose : DrawPoses(markers, &generator)) {
      double cost = 0.0, num_agreeing = 0.0;
      for (const MarkerRays& marker : markers) {
        const double error = ErrorInSides(marker, pose);
        num_agreeing += error < 1.0;
        cost += error < 1.0 ? error * error : 1.0;
      }
      if (!(cost < least_cost)) continue;
      least_cost = cost;
      best_pose = pose;
      agreeing_part = num_agreeing / static_cast<double>(markers.size());
    }
  }
  return best_pose;
}

Eigen::Isometry3d Refine(const std::vector<MarkerRays>& markers,
                         const std::vector<std::size_t>& agreeing_idxs,
                         const Eigen::Isometry3d& cam_from_unit) {
  std::vector<cv::Point3d> in_unit;
  std::vector<cv::Point2d> rays;
  for (const std::size_t i : agreeing_idxs) {
    for (std::size_t c = 0; c < kNumCorners; ++c) {
      const Eigen::Vector3d& x = markers[i].corners_in_space[c];
      in_unit.emplace_back(x.x(), x.y(), x.z());
      rays.emplace_back(markers[i].rays[c].x(), markers[i].rays[c].y());
    }
  }
  const Eigen::AngleAxisd turn(cam_from_unit.linear());
  const Eigen::Vector3d axis_angle = turn.angle() * turn.axis();
  cv::Vec3d rotation_vector(axis_angle.x(), axis_angle.y(), axis_angle.z());
  const Eigen::Vector3d& t = cam_from_unit.translation();
  cv::Vec3d translation(t.x(), t.y(), t.z());
  cv::solvePnPRefineLM(in_unit, rays, cv::Matx33d::eye(), cv::noArray(), rotation_vector,
                       translation);
  return ToIsometry({rotation_vector[0], rotation_vector[1], rotation_vector[2]},
                    {translation[0], translation[1], translation[2]});
}

bool IsEnough(std::size_t num_agreeing, std::size_t num_markers) {
  return num_agreeing >= kMinConsensus && 2 * num_agreeing >= num_markers;
}

}  // namespace

std::optional<ConsensusPose> FindConsensusPose(std::vector<MarkerRays> markers) {
  if (markers.size() < kMinConsensus) return std::nullopt;
  const std::optional<UnitFrame> frame = CenterAndScale(&markers);
  if (!frame) return std::nullopt;
  Eigen::Isometry3d cam_from_unit = FindConsensus(markers);
  for (int round = 0; round < kNumRounds; ++round) {
    const std::vector<std::size_t> agreeing_idxs = Agreeing(markers, cam_from_unit);
    if (!IsEnough(agreeing_idxs.size(), markers.size())) return std::nullopt;
    cam_from_unit = Refine(markers, agreeing_idxs, cam_from_unit);
  }
  ConsensusPose pose{CamFromSpace(cam_from_unit, *frame), Agreeing(markers, cam_from_unit)};
  if (!IsEnough(pose.agreeing_idxs.size(), markers.size())) return std::nullopt;
  return pose;
}

}  // namespace velamap
