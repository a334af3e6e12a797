// The model of a synthetic scene without an error.

#pragma once

#include "reconstruct/model/model.h"
#include "tests/support/synthetic_scene.h"

namespace velamap {

// A unit of models that cannot pass for the metre.
constexpr double kOtherUnit_m = 2.0;

// True poses and points in units of `unit_m`, the detections of the frames as tracks. Image i + 1
// is frame i; keypoints are in the order of the detections.
Model TrueModel(const SyntheticScene& scene, double unit_m = 1.0);

}  // namespace velamap
