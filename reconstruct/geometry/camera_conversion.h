// One camera as another model.

#pragma once

#include "importer/camera/camera.h"

namespace velamap {

// The camera of this `model` whose image positions are nearest to those of `camera` over the image
// (least squares over a grid of positions; those that `camera` cannot have seen, beyond a fold of
// its distortion, do not count). Exact where the model contains the camera.
Camera ConvertCamera(const Camera& camera, CameraModel model);

}  // namespace velamap
