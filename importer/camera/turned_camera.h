// Cameras of pictures whose pixels were turned by quarters of a turn.

#pragma once

#include <Eigen/Core>

#include "importer/camera/camera.h"

namespace velamap {

// The camera of the same pictures after their pixels are turned clockwise by `quarter_turns` times
// 90 degrees (any integer; multiples of 4 change nothing). Exact for every model.
Camera TurnCamera(const Camera& camera, int quarter_turns);

// Where the turn takes an image position, px; `camera` is that of the picture before it.
Eigen::Vector2d TurnInImage(const Camera& camera, int quarter_turns,
                            const Eigen::Vector2d& x_in_image_px);

// Whether one picture is as wide as the other is high and the other way round, but for a scale (to
// half a pixel), and neither is square.
bool IsTransposedSize(const Camera& camera, int width_px, int height_px);

}  // namespace velamap
