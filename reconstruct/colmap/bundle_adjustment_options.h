// Options of the bundle adjustment, bundle_adjustment.h.

#pragma once

#include <string>

#include "importer/base/ids.h"
#include "importer/base/option.h"

namespace velamap {

struct BundleAdjustmentOptions {
  std::string colmap_path = "colmap";
  bool refine_focal_length = false;  // a given calibration is held fixed
  bool refine_principal_point = false;
  bool refine_extra_params = false;
  int max_num_iterations = 100;
  double function_tolerance = 1e-6;
  bool remove_outliers = true;  // false: COLMAP's adjustment alone, once
  // COLMAP's adjustment has no robust loss, so observations are judged between rounds: those beyond
  // outlier_ratio robust sigmas of all residuals are left out, but never below
  // min_outlier_error_px; one that was left out and fits again returns.
  int max_num_rounds = 6;
  double outlier_ratio = 6.0;
  double min_outlier_error_px = 0.5;
  int min_track_length = 2;
  double time_limit_min = 60.0;    // of one run of COLMAP; one that takes longer is ended
  double max_mean_error_px = 5.0;  // a model with a larger mean reprojection error is refused

  void Check() const;  // throws InputError that names the option
};

Option ColmapPathOption(BundleAdjustmentOptions* options);
OptionGroup DescribeOptions(BundleAdjustmentOptions* options);

// Throws DataError if the mean reprojection error of an adjusted model is above max_mean_error_px
// or not a number. The cause may be a wrong calibration if `has_calibration`.
void CheckMeanError(double mean_error_px, double max_mean_error_px, bool has_calibration);

// Throws the InputError for refine_extra_params where the refined distortion of a camera folds over
// inside the image.
[[noreturn]] void ThrowFoldedDistortion(CameraId camera_id);

}  // namespace velamap
