// Reads a camera calibration and turns it into the COLMAP camera model that holds it exactly.

#pragma once

#include <string>

#include "importer/camera/camera.h"

namespace velamap {

// Reads `path`: an OpenCV FileStorage file (YAML, XML, JSON) with image_width, image_height,
// camera_matrix, distortion_coefficients (none, 4, 5 or 8 values) and optionally
// distortion_model: fisheye (4 values), or a COLMAP cameras.txt that holds one camera.
//
// An OpenCV principal point counts from the first pixel's centre; the 0.5 px that COLMAP's image
// frame adds is added here and nowhere else. Chosen models: PINHOLE without distortion, OPENCV for
// k1 k2 p1 p2, FULL_OPENCV with k3..k6, OPENCV_FISHEYE. A cameras.txt is taken as it is.
//
// Throws InputError that names the file, the key or line, and what was expected.
Camera ReadCalibration(const std::string& path);

// The camera for frames of another size: parameters are scaled if the aspect ratio is the same to
// within half a pixel. Throws InputError, naming `calibration_path`, for any other size.
Camera ScaleToImageSize(const Camera& camera, int width_px, int height_px,
                        const std::string& calibration_path);

}  // namespace velamap
