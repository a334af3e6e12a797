// A calibration as a page to look at: one HTML file without scripts and without anything from
// outside.

#pragma once

#include <iosfwd>
#include <string>

#include "reconstruct/camera_calibration.h"

namespace velamap {

// `dictionary` is the name of the markers' dictionary.
void WriteCalibrationPage(const CameraCalibration& calibration, const std::string& dictionary,
                          std::ostream& out);

}  // namespace velamap
