// Lenses and camera paths of rendered clips.

#pragma once

#include "tests/support/clip_scene.h"

namespace velamap {

// An action camera of 109 degrees (f = 1750 px at 3840 px width) or a webcam of 68 degrees, both
// OPENCV with distortion.
Camera MakeClipCamera(bool wide_angle, int width_px);

// The camera goes around the vertical through `middle_m` as from a second boat: it drifts from one
// side to the other in the course of the clip, sways, rises and falls, turns, and shakes as a hand
// or an engine does.
CameraPath MakeOrbit(const ClipOptions& options, const Eigen::Vector3d& middle_m,
                     double camera_height_m, double drift_deg);

// The board of the thesis's section 4.1 is turned in front of a camera at rest.
CameraPath MakeBoardMotion(const ClipOptions& options);

}  // namespace velamap
