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

// Half the way from the image before to the one after, whatever moves: camera, boat or cloth. An
// image needs both within 0.15 s; photographs have none. A marker that one of them lacks moves as
// the affine field that its neighbours in the image fit best. Images without velocities are
// missing.
CornerVelocities CornerVelocitiesOf(const std::vector<DatabaseImage>& images);

// The movement of a corner from when the middle row is read to when its own is, px, by one second
// from the first row to the last.
Eigen::Vector2d ShutterDirection(const Camera& camera, const Eigen::Vector2d& x_in_image_px,
                                 const Eigen::Vector2d& velocity_px_s);

// Moves the image points to where they are while the middle row is read.
void MoveToMiddleRow(double rolling_shutter_s, const CornerVelocities& velocities_px_s,
                     Model* model);

}  // namespace velamap
