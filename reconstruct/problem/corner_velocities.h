// How fast corners move through the images of a video, from the frames before and after.

#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "importer/database/colmap_database.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Velocities of the corners of one image by point2D_idx, px/s.
using CornerVelocities = std::map<ImageId, std::vector<Eigen::Vector2d>>;

// The slope of a polynomial through the places of a marker in the frame, the two before and the two
// after it (or one each), whether camera, boat or cloth moves. The velocities of its corners, and
// of markers that the neighbouring frames do not show, follow from the affine field that fits all
// markers of the image best. Over a shake of 3 Hz the straight line through two frames at 30 Hz is
// 7 % too slow, the polynomial through five 0.5 %. Steps between frames may take 0.15 s;
// photographs have no velocities. Images without velocities are missing.
CornerVelocities CornerVelocitiesOf(const std::vector<DatabaseImage>& images);

// How far a corner moves between the time when the middle row is read and the time when its own row
// is, px, if reading the frame takes one second.
Eigen::Vector2d ShutterDirection(const Camera& camera, const Eigen::Vector2d& x_in_image_px,
                                 const Eigen::Vector2d& velocity_px_s);

// Moves the image points to where they are while the middle row is read.
void MoveToMiddleRow(double rolling_shutter_s, const CornerVelocities& velocities_px_s,
                     Model* model);

}  // namespace velamap
