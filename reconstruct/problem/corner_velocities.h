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

// The slope of a polynomial through the places of a marker in the frame, two before and two after
// it, or one each, whatever moves: camera, boat or cloth. Its corners and the markers that the
// frames beside it lack follow from the affine field that all markers of the image fit best. Over a
// shake of 3 Hz the straight line through two frames at 30 Hz is 7 % too slow, the polynomial
// through five 0.5 %. Steps between frames may take 0.15 s; photographs tell nothing. Images
// without velocities are missing.
CornerVelocities CornerVelocitiesOf(const std::vector<DatabaseImage>& images);

// The movement of a corner from when the middle row is read to when its own is, px, by one second
// from the first row to the last.
Eigen::Vector2d ShutterDirection(const Camera& camera, const Eigen::Vector2d& x_in_image_px,
                                 const Eigen::Vector2d& velocity_px_s);

// Moves the image points to where they are while the middle row is read.
void MoveToMiddleRow(double rolling_shutter_s, const CornerVelocities& velocities_px_s,
                     Model* model);

}  // namespace velamap
