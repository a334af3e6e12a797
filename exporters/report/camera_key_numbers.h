// The key numbers that judge the camera: its calibration, its shutter, or what was found instead.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/report/report_key_numbers.h"
#include "reconstruct/camera/camera_steadiness.h"

namespace velamap {

// kGood up to `good`, kCheck up to `bad`, else kBad.
ReportStatus LowIsGood(double value, double good, double bad);

// Judges the calibration by its effect: a different one does no harm if it hardly moves the shape.
// kNone if it was not tested.
ReportStatus StatusOf(const CalibrationEvidence& evidence);

// Names the parameter that explains most, and the options that refine it.
std::string CalibrationAdvice(const CalibrationEvidence& evidence);

// The same for a camera that was found from the pictures. No given calibration can be wrong, so the
// pictures do not determine the camera. If the geometry is weak, the warning about it is the
// advice.
std::string FoundCameraAdvice(const std::vector<std::string>& warnings);

// Whether another calibration would explain the residuals. Returns nothing without the marker-aware
// adjustment, which tests it. If no calibration was given, the advice is about the pictures.
std::optional<KeyNumber> CalibrationNumber(const ReportInput& input);

// None for one unchanged camera.
std::optional<KeyNumber> SteadinessNumber(const SteadinessVerdict& steadiness);

// None where the adjustment did not estimate it; `uncertainty` may be null.
std::optional<KeyNumber> RollingShutterNumber(const AdjustmentUncertainty* uncertainty);

// The camera that was found where there is no calibration; the least certain one of several. Its
// uncertainty is part of the shape's sigmas, so an uncertain camera is not a fault in itself.
std::optional<KeyNumber> FoundCameraNumber(const std::vector<EstimatedCamera>& cameras);

}  // namespace velamap
