// Marker-aware bundle adjustment. Its points are corners of squares of known size, printed with
// some tolerance on cloth, which bends a little, or on a rigid part. The result is metric.

#pragma once

#include <map>
#include <string>
#include <vector>

#include "importer/camera/calibration_writer.h"
#include "importer/layout/layout.h"
#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"
#include "reconstruct/problem/corner_errors.h"
#include "reconstruct/problem/marker_adjustment_options.h"

namespace velamap {

struct MarkerAdjustmentSummary {
  int num_iterations = 0;
  Statistics error_before_px;
  Statistics error_after_px;
  std::vector<RemovedObservation> removed;
  std::vector<ImageId> removed_images;
  AdjustmentUncertainty uncertainty;
  // With find_camera: the cameras of the result and their sigmas, which include the uncertainty of
  // shape and poses.
  std::map<CameraId, EstimatedCamera> cameras;
  // Messages about weak geometry (all views from one place, a flat board seen head-on, pure
  // rotation), scale bars that contradict each other or the markers, parts that disagree, and
  // markers whose size contradicts the others.
  std::vector<std::string> warnings;
};

// Adjusts a model of marker corners of any scale. The result is metric, its world frame is the
// first image's camera, and its point errors are up to date. Throws DataError if nothing can be
// adjusted, the mean error stays above max_mean_error_px, or the images leave the shape
// undetermined, and InputError if refine_extra_params is set and the refined distortion folds over
// inside the image. The model is unchanged if it throws.
MarkerAdjustmentSummary AdjustWithMarkers(const MarkerAdjustmentOptions& options,
                                          const Layout& layout, const CornerErrors& corner_errors,
                                          Model* model);

}  // namespace velamap
