#include "reconstruct/geometry/marker_pose.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/calib3d.hpp>

#include "importer/geometry/opencv_pose.h"
#include "importer/geometry/pose_refinement.h"

namespace velamap {
namespace {

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
  std::vector<cv::Point2d> image_points;  // undistorted: any camera model serves
  std::vector<RayObservation> observations;
  for (int i = 0; i < kNumCorners; ++i) {
    const auto ray = CamFromImage(camera, corners_in_image_px[i]);
    if (!ray) return {};
    image_points.emplace_back(ray->x(), ray->y());
    const Eigen::Vector3d& corner = corners_in_marker[i];
    observations.push_back({corner, *ray});
    object_points.emplace_back(corner.x(), corner.y(), corner.z());
  }
  std::vector<cv::Mat> rotation_vectors, translations;
  cv::solvePnPGeneric(object_points, image_points, cv::Matx33d::eye(), cv::noArray(),
                      rotation_vectors, translations, false, cv::SOLVEPNP_IPPE_SQUARE);
  std::vector<MarkerPose> poses;
  for (std::size_t i = 0; i < rotation_vectors.size(); ++i) {
    // IPPE alone is off by tenths of a pixel for a marker that faces the camera exactly.
    const Rigid3 cam_from_marker =
        RefinePose(observations, RigidFromOpenCV(rotation_vectors[i], translations[i]));
    const auto error = RmsError(camera, cam_from_marker, corners_in_marker, corners_in_image_px);
    if (error) poses.push_back({cam_from_marker, *error});
  }
  std::sort(poses.begin(), poses.end(), [](const MarkerPose& a, const MarkerPose& b) {
    return a.rms_error_px < b.rms_error_px;
  });
  return poses;
}

}  // namespace velamap
