#include "reconstruct/model/model_records.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

namespace velamap {

std::optional<Eigen::Quaterniond> RotationFromFile(const Eigen::Vector4d& wxyz) {
  constexpr double kRounding = 1e-12;
  const double norm = wxyz.norm();
  if (!std::isfinite(norm) || norm == 0.0) return std::nullopt;
  const Eigen::Vector4d unit = std::abs(norm - 1.0) <= kRounding ? wxyz : wxyz / norm;
  return Eigen::Quaterniond(unit[0], unit[1], unit[2], unit[3]);
}

std::vector<TrackElement> SortedTrack(const Point3D& point) {
  std::vector<TrackElement> track = point.track;
  std::sort(track.begin(), track.end(), [](const TrackElement& a, const TrackElement& b) {
    return std::tie(a.image_id, a.point2D_idx) < std::tie(b.image_id, b.point2D_idx);
  });
  return track;
}

std::string UnknownCameraModel(CameraId camera_id, const std::string& found) {
  return fmt::format(
      "camera {} has the camera model {}; velamap reads SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, "
      "RADIAL, OPENCV, OPENCV_FISHEYE, FULL_OPENCV (0 to 6)",
      camera_id, found);
}

std::string NoRotation(ImageId image_id) {
  return fmt::format("image {} has no valid rotation", image_id);
}

}  // namespace velamap
