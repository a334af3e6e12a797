// A calibration as a page to look at: one HTML file without scripts or external resources.

#pragma once

#include <iosfwd>
#include <string>

#include "reconstruct/camera_calibration.h"

namespace velamap {

// `board` says what was filmed, such as "markers of DICT_4X4_50".
void WriteCalibrationPage(const CameraCalibration& calibration, const std::string& board,
                          std::ostream& out);

}  // namespace velamap
