// The camera of one frame: the calibration adapted to the frame, or a guess without a calibration.

#pragma once

#include "importer/camera/camera.h"
#include "importer/marker_importer.h"
#include "importer/video/frame_source.h"

namespace velamap {

// The calibration, scaled to the frame's size. If the calibration is for upright pictures and
// the pixels of a photograph are stored on their side, it is turned as EXIF says. Without a
// calibration, UnknownCamera() with the focal length that EXIF claims. Throws InputError, naming
// the image, for a calibration of another aspect ratio. Thread-safe.
Camera CameraOfFrame(const MarkerImporterOptions& options, bool is_video, const Frame& frame);

// Whether `camera` is what CameraOfFrame() returns for some frame with the calibration of
// `options`.
bool IsSameCalibration(const MarkerImporterOptions& options, const Camera& camera);

}  // namespace velamap
