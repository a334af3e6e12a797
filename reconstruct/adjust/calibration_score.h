// Whether another calibration would explain the residuals of an adjustment with a fixed one.

#pragma once

#include "reconstruct/model/calibration_evidence.h"
#include "reconstruct/model/model.h"
#include "reconstruct/problem/marker_problem.h"
#include "reconstruct/problem/normal_equations.h"

namespace velamap {

// Score test (Rao 1948) of eight small warps of the image, which span what a wrong focal length,
// aspect, principal point, and radial and tangential distortion do to it: polynomials of the field.
// Each passes through the linearized adjustment, which takes up with poses and shape what they can;
// what is left of the warps is fitted to all residuals, the corners' and those of the markers'
// sides, which a wrong calibration makes too long near the centre and too short near the border or
// the other way round. The warps that the camera model itself refines are left to it. Of several
// cameras, the one with the strongest evidence. `problem` belongs to `state` at its solution and
// has no loss and calibrated sigmas, which contain the correlation of errors.
CalibrationEvidence TestCalibration(const Model& model, const MarkerState& state,
                                    const MarkerProblem& problem, const MarkerJacobian& jacobian,
                                    const MarkerCovariance& covariance);

}  // namespace velamap
