// Judges a calibration and says how to improve it.

#pragma once

#include <string>
#include <vector>

#include "exporters/report/verdict.h"
#include "reconstruct/camera_calibration.h"

namespace velamap {

// Bad: do not use the camera file. Check: it is less certain than it could be. Each reason ends
// with what to do.
Verdict JudgeCalibration(const CameraCalibration& calibration);

// Views that would make the calibration better, one sentence each; empty if nothing is missing.
std::vector<std::string> AdvisedViews(const CameraCalibration& calibration);

// `bent by 0.31 +- 0.02 % of its extent (RMS), ...`.
std::string DescribeBoard(const BoardFlaws& board);

}  // namespace velamap
