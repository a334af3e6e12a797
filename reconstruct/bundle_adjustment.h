// Bundle adjustment by COLMAP's own program, judged by its result (thesis section 3.5.1).

#pragma once

#include <string>
#include <vector>

#include "reconstruct/model.h"
#include "reconstruct/statistics.h"

namespace velamap {

struct BundleAdjustmentOptions {
  std::string colmap_path = "colmap";
  bool refine_focal_length = false;  // a given calibration is held fixed
  bool refine_principal_point = false;
  bool refine_extra_params = false;
  int max_num_iterations = 100;
  double function_tolerance = 1e-6;
  // COLMAP's adjustment has no robust loss, so observations are cleaned between rounds: those
  // beyond outlier_ratio robust sigmas of all residuals, but never below min_outlier_error_px.
  int max_num_rounds = 4;
  double outlier_ratio = 6.0;
  double min_outlier_error_px = 0.5;
  int min_track_length = 2;
  // A mean reprojection error above this is no result, px.
  double max_mean_error_px = 5.0;

  void Check() const;  // throws InputError that names the option
};

struct RemovedObservation {
  ImageId image_id = 0;
  CornerId corner;
  double error_px = 0.0;
};

struct BundleAdjustmentSummary {
  int num_rounds = 0;
  Statistics error_before_px;
  Statistics error_after_px;
  std::vector<RemovedObservation> removed;  // outliers, in the order of their removal
};

// Adjusts the model in rounds: COLMAP's bundle_adjuster, then removal of outliers, until none is
// left. The model is ordered for the gauge first and has the same image order, true point errors
// and (up to removed ones) the same points after. Throws ExternalToolError if COLMAP fails or its
// result is implausible (images or points lost, numbers not finite, error grown), DataError when
// the mean error stays above max_mean_error_px or nothing is left. `log_path` gets COLMAP's output.
BundleAdjustmentSummary AdjustWithColmap(const BundleAdjustmentOptions& options,
                                         const std::string& log_path, Model* model);

}  // namespace velamap
