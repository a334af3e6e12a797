// Expresses a camera in another camera model.

#pragma once

#include "importer/camera/camera.h"

namespace velamap {

// Index of k4, the first parameter of FULL_OPENCV's denominator.
constexpr int kBeginOfDenominator = 9;

// The camera of this `model` whose image positions are nearest to those of `camera` over the image
// (least squares over a grid of positions; those that `camera` cannot have seen, beyond a fold of
// its distortion, do not count). Exact where the model contains the camera. A FULL_OPENCV camera
// gets no denominator.
Camera ConvertCamera(const Camera& camera, CameraModel model);

}  // namespace velamap
