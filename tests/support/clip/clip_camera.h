// The lenses and camera paths of rendered clips.

#pragma once

#include "tests/support/clip/clip_scene.h"

namespace velamap {

// An action camera of 109 degrees (f = 1750 px at 3840 px width) or a webcam of 68 degrees, both
// OPENCV with distortion.
Camera MakeClipCamera(bool wide_angle, int width_px);

// A camera on a second boat that circles the vertical through `middle_m`. In the course of the clip
// it drifts from one side to the other; meanwhile it sways, heaves, turns, and shakes as if held by
// hand or near an engine.
CameraPath MakeOrbit(const ClipOptions& options, const Eigen::Vector3d& middle_m,
                     double camera_height_m, double drift_deg);

// A camera at rest, in front of which the board of section 4.1 of the thesis moves.
CameraPath MakeBoardMotion(const ClipOptions& options);

}  // namespace velamap
