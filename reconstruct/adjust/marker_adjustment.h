// Bundle adjustment of our own, in Ceres, that knows what the points are: corners of squares of
// known size, printed with some tolerance on cloth that bends a little or on something rigid. The
// result is metric.

#pragma once

#include <map>
#include <optional>
#include <vector>

#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "reconstruct/adjust/marker_adjustment_options.h"
#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"

namespace velamap {

// 1 sigma of a coordinate, px, by point2D_idx; 0 or a missing image: unknown.
using CornerSigmas = std::map<ImageId, std::vector<double>>;
CornerSigmas CornerSigmasOf(const std::vector<DatabaseImage>& images);

struct MarkerAdjustmentSummary {
  int num_iterations = 0;
  Statistics error_before_px;
  Statistics error_after_px;
  std::vector<RemovedObservation> removed;
  std::vector<ImageId> removed_images;
  AdjustmentUncertainty uncertainty;
  // Plain words on weak geometry (all views from one place, a flat board seen head-on, pure
  // rotation), a scale bar that contradicts the markers, markers whose size contradicts the others.
  std::vector<std::string> warnings;
};

// Starts from any model of marker corners, whatever its scale; returns it metric, in the frame of
// its first image's camera, with true point errors. Throws DataError where nothing can be adjusted,
// the mean error stays above max_mean_error_px, or the geometry leaves a shape undetermined; the
// model is untouched then.
MarkerAdjustmentSummary AdjustWithMarkers(const MarkerAdjustmentOptions& options,
                                          const Layout& layout, const CornerSigmas& corner_sigmas,
                                          Model* model);

}  // namespace velamap
