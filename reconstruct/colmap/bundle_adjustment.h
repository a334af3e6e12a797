// Bundle adjustment by COLMAP's own program (thesis section 3.5.1).

#pragma once

#include <string>
#include <vector>

#include "importer/base/statistics.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct BundleAdjustmentOptions {
  std::string colmap_path = "colmap";
  bool refine_focal_length = false;  // a given calibration is held fixed
  bool refine_principal_point = false;
  bool refine_extra_params = false;
  int max_num_iterations = 100;
  double function_tolerance = 1e-6;
  // COLMAP's adjustment has no robust loss, so observations are judged between rounds: those beyond
  // outlier_ratio robust sigmas of all residuals are left out, but never below
  // min_outlier_error_px; one left out that has come to fit returns.
  int max_num_rounds = 6;
  double outlier_ratio = 6.0;
  double min_outlier_error_px = 0.5;
  int min_track_length = 2;
  // A mean reprojection error above this is no result, px.
  double max_mean_error_px = 5.0;

  void Check() const;  // throws InputError that names the option
};

struct RemovedObservation {
  Point3DId point3D_id = 0;
  TrackElement element;
  double error_px = 0.0;  // when it was removed; infinite for a point behind the camera
};

struct BundleAdjustmentSummary {
  int num_rounds = 0;
  Statistics error_before_px;
  Statistics error_after_px;
  std::vector<RemovedObservation> removed;  // outliers, in the order of their removal
  std::vector<ImageId> removed_images;      // too few observations were left to determine the pose
};

// Alternates COLMAP's bundle_adjuster with the removal and restoring of observations until nothing
// changes. The first image of `model` defines the world frame; the scale is arbitrary. Images are
// ordered for the gauge. Images and points with too few observations are removed, and point errors
// are updated. Cameras change only where the options say so.
//
// Throws ExternalToolError if COLMAP fails or its result is implausible (images, points or
// observations are lost, numbers are not finite, the error has grown), and DataError if the mean
// error stays above max_mean_error_px or too little is left to adjust; `model` does not change
// then. COLMAP's output goes to `log_path`.
BundleAdjustmentSummary AdjustWithColmap(const BundleAdjustmentOptions& options,
                                         const std::string& log_path, Model* model);

}  // namespace velamap
