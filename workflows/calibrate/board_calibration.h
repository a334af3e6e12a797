// From pictures of a board to its camera: the importer, then the calibration.

#pragma once

#include <optional>
#include <string>

#include "importer/detect/detection_options.h"
#include "importer/layout/layout.h"
#include "importer/video/video_options.h"
#include "reconstruct/camera_calibration.h"

namespace velamap {

struct BoardCalibrationOptions {
  std::string image_path;        // folder of images, or a video file
  std::optional<Layout> layout;  // nothing: the dictionary is found by trying
  ArucoDetectionOptions detection;
  VideoOptions video;
  CameraCalibrationOptions calibration;
};

struct BoardCalibration {
  std::string dictionary;
  CameraCalibration calibration;
};

// Throws InputError and DataError where ImportMarkers() and CalibrateCamera() do, and DataError
// where no dictionary finds markers.
BoardCalibration CalibrateWithBoard(const BoardCalibrationOptions& options);

}  // namespace velamap
