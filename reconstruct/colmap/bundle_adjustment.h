// Bundle adjustment by COLMAP's own program (thesis section 3.5.1).

#pragma once

#include <string>
#include <vector>

#include "importer/base/statistics.h"
#include "reconstruct/colmap/bundle_adjustment_options.h"
#include "reconstruct/model/model.h"

namespace velamap {

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
