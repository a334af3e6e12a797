// How corners move through the images of a video, from the frames before and after.

#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "importer/database/colmap_database.h"

namespace velamap {

// Derivatives of a corner's place by the time of the frame.
struct CornerMotion {
  Eigen::Vector2d velocity_px_s = Eigen::Vector2d::Zero();
  Eigen::Vector2d acceleration_px_s2 = Eigen::Vector2d::Zero();
};

// By image and point2D_idx.
using CornerMotions = std::map<ImageId, std::vector<CornerMotion>>;

// Motions relative to the picture, whether camera, boat or cloth moves. The motion of a marker is
// that of the polynomial through its places in the frame and in two, or four in slow videos, before
// and as many after it. How it changes within a marker, and the motion of markers that the
// neighbouring frames do not show, follow from the field of all markers of the image
// (motion_field.h). For a shake of 6 Hz at 30 Hz, the straight line through two frames is 24 % too
// slow, the polynomial through five 7 %, that through nine 0.7 %. Frames more than 0.15 s apart are
// not used together, and repeated ones (repeated_frames.h) count as one frame at the time of the
// first. Photographs have no motions. Images without motions are missing.
CornerMotions CornerMotionsOf(const std::vector<DatabaseImage>& images);

}  // namespace velamap
