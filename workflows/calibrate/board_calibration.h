// Calibrates a camera from pictures of a board: runs the importer, then the calibration.

#pragma once

#include <optional>
#include <string>

#include "importer/detect/chessboard.h"
#include "importer/detect/detection_options.h"
#include "importer/layout/layout.h"
#include "importer/video/video_options.h"
#include "reconstruct/camera_calibration.h"

namespace velamap {

struct BoardCalibrationOptions {
  std::string image_path;  // folder of images, or a video file
  // If neither is given, the dictionary of the markers is found by trial.
  std::optional<Layout> layout;
  std::optional<Chessboard> chessboard;
  double square_m = 0.1;  // of the chessboard: the camera does not depend on it, the report does
  ArucoDetectionOptions detection;
  VideoOptions video;
  CameraCalibrationOptions calibration;
};

struct BoardCalibration {
  std::string board;  // "markers of DICT_4X4_50"
  CameraCalibration calibration;
};

// Throws InputError and DataError as ImportMarkers() and CalibrateCamera() do, and DataError if no
// dictionary finds markers.
BoardCalibration CalibrateWithBoard(const BoardCalibrationOptions& options);

}  // namespace velamap
