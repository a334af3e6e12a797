// What the text and the binary form of a COLMAP model have in common.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "reconstruct/model/model.h"

namespace velamap {

// The rotation of a file's quaternion (w, x, y, z): as it stands if it has unit length to rounding,
// so that a model round-trips exactly; else normalised. Nothing for the length zero or not finite.
std::optional<Eigen::Quaterniond> RotationFromFile(const Eigen::Vector4d& wxyz);

// Ordered by image, then 2D point.
std::vector<TrackElement> SortedTrack(const Point3D& point);

// Texts of errors that both forms report.
std::string UnknownCameraModel(CameraId camera_id, const std::string& found);
std::string NoRotation(ImageId image_id);

}  // namespace velamap
