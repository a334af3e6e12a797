// How fast corners move through the images of a video, from the frames before and after.

#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "importer/database/colmap_database.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Velocities of the corners by image and point2D_idx, px/s.
using CornerVelocities = std::map<ImageId, std::vector<Eigen::Vector2d>>;

// Velocities relative to the picture, whether camera, boat or cloth moves. The velocity of a marker
// is the slope of the polynomial through its places in the frame and in the two before and the two
// after it (or one each). The velocities of its corners, and of markers that the neighbouring
// frames do not show, follow from the affine field that fits all markers of the image best. For a
// shake of 3 Hz, the straight line through two frames at 30 Hz is 7 % too slow, the polynomial
// through five 0.5 %. Frames more than 0.15 s apart are not used together, and repeated ones
// (repeated_frames.h) count as one frame at the time of the first. Photographs have no velocities.
// Images without velocities are missing.
CornerVelocities CornerVelocitiesOf(const std::vector<DatabaseImage>& images);

// Derivative of a corner's position with respect to the time from the first row of the frame to the
// last, px/s: how far the corner moves from when the middle row is read to when its own row is, if
// reading the frame takes one second. In portrait frames, which are turned, the sensor's rows are
// the columns of the image, from left to right.
Eigen::Vector2d ShutterDirection(const Camera& camera, const Eigen::Vector2d& x_in_image_px,
                                 const Eigen::Vector2d& velocity_px_s);

// Corrects the image points for the rolling shutter: moves each to its place at the time when the
// middle row is read.
void MoveToMiddleRow(double rolling_shutter_s, const CornerVelocities& velocities_px_s,
                     Model* model);

// Undoes MoveToMiddleRow(): moves each image point back to its place at the time when its own row
// is read.
void MoveFromMiddleRow(double rolling_shutter_s, const CornerVelocities& velocities_px_s,
                       Model* model);

}  // namespace velamap
