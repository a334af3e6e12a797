// The camera of one frame: the calibration adapted to the frame, or a guess without a calibration.

#pragma once

#include "importer/camera/camera.h"
#include "importer/marker_importer.h"
#include "importer/video/frame_source.h"

namespace velamap {

// The calibration for the frame's size; for a photograph that EXIF calls turned, of either
// orientation. Without a calibration UnknownCamera(), with the focal length that EXIF claims.
// Throws InputError, naming the image, for a calibration of another aspect ratio. Thread-safe.
Camera CameraOfFrame(const MarkerImporterOptions& options, bool is_video, const Frame& frame);

// Whether `camera` is what CameraOfFrame() returns for some frame with the calibration of
// `options`.
bool IsSameCalibration(const MarkerImporterOptions& options, const Camera& camera);

}  // namespace velamap
