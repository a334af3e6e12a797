#include "reconstruct/geometry/marker_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Cholesky>

#include <opencv2/calib3d.hpp>

#include "reconstruct/geometry/opencv_pose.h"

namespace velamap {
namespace {

// Levenberg-Marquardt on the rays with analytic derivatives.
// IPPE alone is off by tenths of a pixel for a marker that faces the camera exactly; OpenCV's own
// refinement takes 20 times as long.
Rigid3 RefinePose(const std::array<Eigen::Vector3d, kNumCorners>& corners_in_marker,
                  const std::array<Eigen::Vector2d, kNumCorners>& rays, Rigid3 cam_from_marker) {
  constexpr int kMaxIterations = 20;
  constexpr double kMinStep = 1e-10;  // rad; convergence is fast
  const auto cost_of = [&](const Rigid3& pose) {
    double cost = 0.0;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const Eigen::Vector3d x = pose * corners_in_marker[i];
      if (!(x.z() > 0)) return std::numeric_limits<double>::infinity();
      cost += (x.hnormalized() - rays[i]).squaredNorm();
    }
    return cost;
  };
  double cost = cost_of(cam_from_marker);
  double damping = 1e-6;
  for (int iteration = 0; iteration < kMaxIterations && std::isfinite(cost); ++iteration) {
    Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();
    PoseStep gradient = PoseStep::Zero();
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const Eigen::Vector3d rotated = cam_from_marker.rotation * corners_in_marker[i];
      const Eigen::Vector3d x = rotated + cam_from_marker.translation;
      const Eigen::Matrix<double, 2, 6> jacobian = RayFromPoseStep(rotated, x);
      hessian += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * (x.hnormalized() - rays[i]);
    }
    hessian.diagonal() *= 1 + damping;
    const PoseStep step = -hessian.ldlt().solve(gradient);
    const Rigid3 candidate = Moved(cam_from_marker, step);
    const double candidate_cost = cost_of(candidate);
    if (candidate_cost < cost) {
      cam_from_marker = candidate;
      cost = candidate_cost;
      damping *= 0.1;
    } else {
      damping = std::max(10 * damping, 1e-6);
    }
    if (step.head<3>().norm() < kMinStep || !step.allFinite()) break;
  }
  return cam_from_marker;
}

std::optional<double> RmsError(const Camera& camera, const Rigid3& cam_from_marker,
                               const std::array<Eigen::Vector3d, kNumCorners>& corners_in_marker,
                               const std::array<Eigen::Vector2d, kNumCorners>& corners_px) {
  double sum = 0.0;
  for (int i = 0; i < kNumCorners; ++i) {
    const auto projected = ImageFromCam(camera, cam_from_marker * corners_in_marker[i]);
    if (!projected) return std::nullopt;
    sum += (*projected - corners_px[i]).squaredNorm();
  }
  return std::sqrt(sum / kNumCorners);
}

}  // namespace

std::array<Eigen::Vector3d, kNumCorners> CornersInMarker(double marker_length_m) {
  const double half = marker_length_m / 2;
  return {{{-half, half, 0}, {half, half, 0}, {half, -half, 0}, {-half, -half, 0}}};
}

std::vector<MarkerPose> EstimateMarkerPoses(
    const Camera& camera, const std::array<Eigen::Vector2d, kNumCorners>& corners_in_image_px,
    double marker_length_m) {
  const auto corners_in_marker = CornersInMarker(marker_length_m);
  std::vector<cv::Point3d> object_points;
  std::array<Eigen::Vector2d, kNumCorners> rays;  // undistorted: any camera model serves
  std::vector<cv::Point2d> image_points;
  for (int i = 0; i < kNumCorners; ++i) {
    const auto ray = CamFromImage(camera, corners_in_image_px[i]);
    if (!ray) return {};
    rays[i] = *ray;
    image_points.emplace_back(ray->x(), ray->y());
    const Eigen::Vector3d& corner = corners_in_marker[i];
    object_points.emplace_back(corner.x(), corner.y(), corner.z());
  }
  std::vector<cv::Mat> rotation_vectors, translations;
  cv::solvePnPGeneric(object_points, image_points, cv::Matx33d::eye(), cv::noArray(),
                      rotation_vectors, translations, false, cv::SOLVEPNP_IPPE_SQUARE);
  std::vector<MarkerPose> poses;
  for (std::size_t i = 0; i < rotation_vectors.size(); ++i) {
    const Rigid3 cam_from_marker =
        RefinePose(corners_in_marker, rays, RigidFromOpenCV(rotation_vectors[i], translations[i]));
    const auto error = RmsError(camera, cam_from_marker, corners_in_marker, corners_in_image_px);
    if (error) poses.push_back({cam_from_marker, *error});
  }
  std::sort(poses.begin(), poses.end(), [](const MarkerPose& a, const MarkerPose& b) {
    return a.rms_error_px < b.rms_error_px;
  });
  return poses;
}

}  // namespace velamap
