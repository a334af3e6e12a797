// Bundle adjustment by COLMAP's own program, judged by its result (thesis section 3.5.1).

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
  std::vector<ImageId> removed_images;      // left with too few observations to fix their pose
};

// Adjusts the model in rounds: COLMAP's bundle_adjuster, then judgement of the observations, until
// nothing changes. The first image of `model` gives the world frame. Its images come back ordered
// for the gauge, less the removed ones, its points less those with too short a track, with true
// point errors; the scale is arbitrary. Cameras change only where options say so.
//
// Throws ExternalToolError if COLMAP fails or its result is implausible (images, points or
// observations lost, numbers not finite, error grown), DataError when the mean error stays above
// max_mean_error_px or too little is left to adjust; `model` is untouched then. `log_path` gets
// COLMAP's output.
BundleAdjustmentSummary AdjustWithColmap(const BundleAdjustmentOptions& options,
                                         const std::string& log_path, Model* model);

}  // namespace velamap
