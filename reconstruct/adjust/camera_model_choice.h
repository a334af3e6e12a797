// Chooses the camera model of an unknown camera.

#pragma once

#include <optional>

#include "importer/camera/camera.h"
#include "reconstruct/adjust/marker_solution.h"

namespace velamap {

// Chooses among SIMPLE_RADIAL, RADIAL, OPENCV and OPENCV_FISHEYE by Akaike's information criterion
// (1974): the sum of squares plus two for each parameter, times the square of the factor of
// correlated errors. A superfluous parameter costs little, because its prior constrains it. A
// missing one bends the shape without increasing its sigmas, so the stricter criterion of Schwarz
// is not used. All models are refined from `solution`, whose options have find_camera, and compared
// at the corners' sigmas of the one that leaves the smallest residuals. A fisheye is considered if
// a camera sees more than 35 degrees off its axis. Models that fold over inside the image are
// chosen only if all do. Returns `solution` with all cameras converted to the chosen model.
MarkerSolution WithBestCameraModel(const MarkerSolution& solution);

// Converts the cameras of the solution to this model, with the prior of an unknown camera, and
// refines. Returns nothing if the refinement fails.
std::optional<MarkerSolution> RefinedAs(CameraModel model, MarkerSolution solution);

// Whether WithBestCameraModel() tries this model. It tries a fisheye only if a camera sees more
// than 35 degrees off its axis, because nearer to the axis its many parameters fit noise.
bool IsCandidate(CameraModel model, const MarkerSolution& solution);

// Whether the distortion of any camera folds over inside the picture.
bool HasFoldedCamera(const MarkerSolution& solution);

}  // namespace velamap
