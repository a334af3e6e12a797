// The exact model and shape of a synthetic scene.

#pragma once

#include "exporters/shape/marker_shape.h"
#include "reconstruct/model/model.h"
#include "tests/support/synthetic_scene.h"

namespace velamap {

// A unit of length for models, clearly different from the metre.
constexpr double kOtherUnit_m = 2.0;

// The true poses and points, in units of `unit_m`, with the detections of the frames as tracks.
// Image i + 1 is frame i. Keypoints are in the order of the detections.
Model TrueModel(const SyntheticScene& scene, double unit_m = 1.0);

// All markers of the scene, in its world frame.
MarkerShape TrueShape(const SyntheticScene& scene);

}  // namespace velamap
