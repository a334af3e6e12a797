// The web page of a calibration: one HTML file without scripts or external resources.

#pragma once

#include <iosfwd>
#include <string>

#include "reconstruct/camera_calibration.h"

namespace velamap {

// Describes the source of a calibration, so that the pages of several cameras can be told apart.
struct CalibrationSource {
  std::string pictures;     // name of the clip or the folder
  std::string camera_file;  // name of the file that the calibration is in
  std::string board;        // what was filmed, such as "markers of DICT_4X4_50"
};

// The page says when it was made: OutputDate(), whose errors it throws.
void WriteCalibrationPage(const CameraCalibration& calibration, const CalibrationSource& source,
                          std::ostream& out);

}  // namespace velamap
