// Which camera model the images of an unknown camera speak for.

#pragma once

#include "importer/camera/camera.h"
#include "reconstruct/adjust/marker_solution.h"

namespace velamap {

// Of SIMPLE_RADIAL, RADIAL, OPENCV and OPENCV_FISHEYE the one with the least information criterion
// of Akaike (1974): the sum of squares plus two for each parameter, which counts by the square of
// the factor of the correlated errors. A parameter too many costs little, because the prior knows
// it roughly; one too few bends the shape without a trace in its sigmas, so that the stricter
// criterion of Schwarz is not used here. All models are refined from `solution`, whose options have
// find_camera, and compared at the corners' sigmas of the one that leaves the smallest residuals.
// A fisheye is considered where a camera sees more than 35 degrees off its axis. Models that fold
// over inside the image are taken only where all do. Returns `solution` with the cameras of that
// model, all cameras alike.
MarkerSolution WithBestCameraModel(const MarkerSolution& solution);

// The cameras as this model, with the prior of an unknown camera.
void SetCameraModel(CameraModel model, MarkerSolution* solution);

}  // namespace velamap
