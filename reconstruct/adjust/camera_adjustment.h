// Estimates cameras by adjustment, for images without a calibration and for making one.

#pragma once

#include <map>
#include <optional>
#include <vector>

#include "importer/layout/layout.h"
#include "reconstruct/adjust/camera_cross_validation.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/camera/camera_steadiness.h"
#include "reconstruct/model/model.h"
#include "reconstruct/problem/corner_errors.h"
#include "reconstruct/problem/marker_adjustment_options.h"

namespace velamap {

struct CameraAdjustment {
  std::map<CameraId, Camera> cameras;
  // Sum over all corners of a score that is 1 for an error of 0 and falls to 0 at 0.0005 of the
  // picture's larger side: how much the model explains with these cameras.
  double explained = 0.0;
  // 1 sigma of the first focal length of each camera, px; turned cameras are left out.
  std::map<CameraId, double> focal_sigmas_px;
};

// Adjusts a copy of `model` with all cameras free (find_camera), from their given values, and
// chooses the camera model by the evidence. Throws DataError if nothing can be adjusted.
CameraAdjustment AdjustCameras(const MarkerAdjustmentOptions& options, const Layout& layout,
                               const CornerErrors& corner_errors, const Model& model);

struct CalibrationAdjustment {
  // Metric. Pictures that were turned are turned back, so that there is one camera.
  Model model;
  MarkerAdjustmentSummary summary;  // with its camera
  std::vector<CameraModelScore> scores;
};

// Adjusts a model to calibrate its camera. The camera model is the one that predicts unseen
// pictures best (camera_cross_validation.h), or the `wanted` one. Throws DataError as
// AdjustWithMarkers() does.
CalibrationAdjustment AdjustForCalibration(const MarkerAdjustmentOptions& options,
                                           const Layout& layout, const CornerErrors& corner_errors,
                                           Model model, std::optional<CameraModel> wanted);

// Returns `step`, the step of the focal length in a verdict on steadiness (camera_steadiness.h), if
// it is certain, or if it is suspicious and MeasureFocalStep() confirms it in `seed`, the model
// before its adjustment (may be null). Measured values replace those of the verdict.
std::optional<FocalStep> ConfirmFocalStep(const MarkerAdjustmentOptions& options,
                                          const Layout& layout, const CornerErrors& corner_errors,
                                          const Model* seed, const std::optional<FocalStep>& step);

// Measures a step of the focal length at `step` by an adjustment in which the images from there on,
// or those of the second group, have their own camera; `model` is the model before its adjustment.
// Returns nothing if the focal lengths agree to 1 % or to ten sigmas, or if one part alone cannot
// be adjusted.
std::optional<FocalStep> MeasureFocalStep(const MarkerAdjustmentOptions& options,
                                          const Layout& layout, const CornerErrors& corner_errors,
                                          Model model, FocalStep step);

}  // namespace velamap
