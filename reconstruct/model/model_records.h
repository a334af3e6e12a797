// Shared by the text and the binary format of COLMAP models.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "reconstruct/model/model.h"

namespace velamap {

// The rotation of a file's quaternion (w, x, y, z). It is normalized unless its length is 1 up to
// rounding, so that models round-trip exactly. Returns nothing if its length is zero or not finite.
std::optional<Eigen::Quaterniond> RotationFromFile(const Eigen::Vector4d& wxyz);

// Ordered by image, then 2D point.
std::vector<TrackElement> SortedTrack(const Point3D& point);

// Messages for errors in both formats.
std::string UnknownCameraModel(CameraId camera_id, const std::string& found);
std::string NoRotation(ImageId image_id);

}  // namespace velamap
