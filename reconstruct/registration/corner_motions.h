// How corners move through the images of a video, from the frames before and after.

#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "importer/database/colmap_database.h"

namespace velamap {

// Derivatives of a corner's place with respect to time, at the time of the frame.
struct CornerMotion {
  Eigen::Vector2d velocity_px_s = Eigen::Vector2d::Zero();
  Eigen::Vector2d acceleration_px_s2 = Eigen::Vector2d::Zero();
  Eigen::Vector2d jerk_px_s3 = Eigen::Vector2d::Zero();
  // 1 sigma of a coordinate of the velocity, and the part of it that all corners of the image
  // share. 0: unknown.
  double velocity_sigma_px_s = 0.0;
  double shared_sigma_px_s = 0.0;
};

// By image and point2D_idx.
using CornerMotions = std::map<ImageId, std::vector<CornerMotion>>;

// Motions relative to the picture, whether camera, boat or cloth moves. The motion of a marker is
// that of a smooth path through its places in the frame and in up to eight before and after it
// (track_smoothing.h). Frames between two that show it get a place from the other markers
// (track_gaps.h), because otherwise each marker would follow a shake as its own frames happen to
// show it, and these differences would pass for motion. How the motion changes within a marker, and
// the motion of markers that the neighbouring frames do not show, follow from the field of all
// markers of the image (motion_field.h). The difference between the velocity of a marker and that
// of the field is shrunk by the share of noise in it. This gives E(velocity | frames), whose errors
// do not bias what is estimated from it (Carroll et al., "Measurement error in nonlinear models",
// 2006, on Berkson errors and regression calibration). Frames more than 0.15 s apart are not used
// together, and repeated ones (repeated_frames.h) count as one frame at the time of the first.
// Photographs have no motions. Images without motions are missing.
CornerMotions CornerMotionsOf(const std::vector<DatabaseImage>& images);

}  // namespace velamap
