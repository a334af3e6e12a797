// The key numbers that judge the camera: its calibration, its shutter, or what was found instead.

#pragma once

#include <optional>
#include <vector>

#include "exporters/report/report_key_numbers.h"

namespace velamap {

// kGood up to `good`, kCheck up to `bad`, else kBad.
ReportStatus LowIsGood(double value, double good, double bad);

// Decided by the effect: a change of the calibration that the residuals ask for but that hardly
// moves the shape harms nobody. kNone where it was not tested.
ReportStatus StatusOf(const CalibrationEvidence& evidence);

// Whether another calibration would explain the residuals. None without the marker-aware
// adjustment, which tests it; `uncertainty` may be null.
std::optional<KeyNumber> CalibrationNumber(const AdjustmentUncertainty* uncertainty);

// None where the adjustment did not estimate it; `uncertainty` may be null.
std::optional<KeyNumber> RollingShutterNumber(const AdjustmentUncertainty* uncertainty);

// The camera that was found instead of a calibration; of several, the one that is known worst. Its
// uncertainty is part of the shape's sigmas, so that a vague one is no fault as such.
std::optional<KeyNumber> FoundCameraNumber(const std::vector<EstimatedCamera>& cameras);

}  // namespace velamap
