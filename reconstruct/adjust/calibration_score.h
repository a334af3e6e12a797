// Tests whether another calibration would explain the residuals of an adjustment with a fixed one.

#pragma once

#include "reconstruct/adjust/marker_solution.h"
#include "reconstruct/model/calibration_evidence.h"

namespace velamap {

// Score test (Rao 1948) of eight small warps of the image. They are polynomials of the image
// position and span the effects of a wrong focal length, aspect, principal point, and radial and
// tangential distortion. The linearized adjustment absorbs as much of each warp as poses and shape
// can; the rest is fitted to all residuals. These include the sides of the markers, which a wrong
// calibration makes too long near the centre and too short near the border, or vice versa. If the
// adjustment refines a warp, only the part that its prior suppresses is tested. For several
// cameras, returns the strongest evidence. `linearization` is that of the solution `model`, with
// calibrated sigmas that contain the correlation of errors.
CalibrationEvidence TestCalibration(const Model& model, const MarkerLinearization& linearization);

}  // namespace velamap
