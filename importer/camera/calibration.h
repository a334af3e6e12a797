// Reads a camera calibration into the COLMAP camera model that represents it exactly.

#pragma once

#include <string>

#include "importer/camera/camera.h"

namespace velamap {

// Reads `path`: an OpenCV FileStorage file (YAML, XML, JSON) with image_width, image_height,
// camera_matrix, distortion_coefficients (none, 4, 5 or 8 values) and optionally
// distortion_model: fisheye (4 values), or a COLMAP cameras.txt that holds one camera.
//
// An OpenCV calibration becomes PINHOLE without distortion, OPENCV with k1 k2 p1 p2, FULL_OPENCV
// with k3..k6, or OPENCV_FISHEYE. OpenCV's principal point is relative to the centre of the first
// pixel, COLMAP's to its corner; the 0.5 px between them are added here and nowhere else.
//
// Warns of a distortion that folds over inside the picture (HasMonotonicDistortion()). Throws
// InputError that names the file, the key or line, and what was expected.
Camera ReadCalibration(const std::string& path);

// Whether images of this size have the camera's aspect ratio, to half a pixel, so that scaling
// adapts the camera to them.
bool IsPureScale(const Camera& camera, int width_px, int height_px);

// Returns the camera for frames of another size, with its parameters scaled. Throws InputError,
// naming `calibration_path`, unless that is a pure scale.
Camera ScaleToImageSize(const Camera& camera, int width_px, int height_px,
                        const std::string& calibration_path);

}  // namespace velamap
