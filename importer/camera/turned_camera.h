// Cameras of pictures whose pixels were turned by multiples of 90 degrees.

#pragma once

#include <Eigen/Core>

#include "importer/camera/camera.h"

namespace velamap {

// The camera of the same pictures after their pixels are turned clockwise by `quarter_turns` times
// 90 degrees (any integer; multiples of 4 change nothing). Exact for every model.
Camera TurnCamera(const Camera& camera, int quarter_turns);

// The image position (px) after the turn; `camera` is the camera of the picture before the turn.
Eigen::Vector2d TurnInImage(const Camera& camera, int quarter_turns,
                            const Eigen::Vector2d& x_in_image_px);

// Whether one size is the other turned by 90 degrees, up to a scale (to half a pixel). Returns
// false for squares.
bool IsTransposedSize(const Camera& camera, int width_px, int height_px);

}  // namespace velamap
