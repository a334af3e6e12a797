// How well each camera model predicts pictures that it was not fitted to.

#pragma once

#include <map>
#include <optional>
#include <vector>

#include "importer/camera/camera.h"
#include "reconstruct/adjust/marker_solution.h"

namespace velamap {

struct CameraModelScore {
  CameraModel model = CameraModel::kPinhole;
  double unseen_error_px = 0.0;  // RMS over the corners of pictures that took no part in the fit
  double seen_error_px = 0.0;    // RMS over all corners in the fit to all pictures
  bool is_folded = false;        // its distortion folds over inside the picture
};

struct CrossValidation {
  std::vector<CameraModelScore> scores;  // by number of parameters, a fisheye last
  MarkerSolution best;                   // with the chosen model, refined
};

// Cross-validation (Stone, "Cross-validatory choice and assessment of statistical predictions",
// 1974) of SIMPLE_PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV without a denominator and
// OPENCV_FISHEYE: every fifth image is left out, camera and points are refined from the others, and
// each image that was left out gets a pose. The errors that remain at its corners are pooled over
// the five divisions. Chooses the model with the smallest error, but one with more parameters only
// if it is better by more than chance, and one that folds over inside the picture only if all do.
// Chooses `wanted` regardless of the errors. A fisheye is tried if a camera sees more than 35
// degrees off its axis. All models are refined from `solution`, whose options have find_camera, and
// judged by the same corners. Throws DataError if none can be refined, or the wanted one cannot.
CrossValidation CrossValidateCameraModels(const MarkerSolution& solution,
                                          std::optional<CameraModel> wanted);

// Returns the solution with the model that leaves the smallest residuals, however well it predicts.
// Corners that contradict even this model are outliers; those that contradict only a simpler one
// may be right, because the simpler model may not describe the lens.
MarkerSolution WithMostFlexibleModel(const MarkerSolution& solution);

// 1 sigma of the parameters of each camera by the jackknife (Tukey 1958): up to twenty groups of
// consecutive pictures (GroupImages()) are left out in turn. It shows how far the cameras of other
// pictures of the same kind would differ. The covariance of the adjustment accounts for errors that
// pictures share, and for those of the camera model, by one factor for all parameters
// (error_correlation.h); the jackknife takes them from the scatter of each parameter. Empty if
// fewer than two groups can be left out.
std::map<CameraId, std::vector<double>> JackknifeCameras(const MarkerSolution& solution);

}  // namespace velamap
