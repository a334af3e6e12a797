// The steps of a marker-aware bundle adjustment, in the order in which marker_adjustment.h and
// camera_adjustment.h take them.

#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "reconstruct/adjust/camera_cross_validation.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/adjust/marker_solution.h"

namespace velamap {

class MarkerAdjuster {
 public:
  // `layout` and `corner_errors` must outlive the adjuster.
  MarkerAdjuster(const MarkerAdjustmentOptions& options, const Layout& layout,
                 const CornerErrors& corner_errors, Model model);

  // Removes outliers of the seed and underconstrained images and points, scales the model to metres
  // by the median of the marker sides and moves the world to the first image's camera. Throws
  // DataError if too little is left.
  void PrepareSeed();

  // Adjusts the seed. If the result shows a rolling shutter, adjusts the seed again with the
  // readout time as a parameter.
  void AdjustFromSeed();

  // Adjusts the seed again, with those intrinsics free that the images determine better than the
  // calibration does, if this explains the corners significantly better.
  void RefineCalibration();

  // With find_camera: takes the model that explains the images best.
  void ChooseCameraModel();
  // Chooses it by cross-validation instead (camera_cross_validation.h), or takes the `wanted` one.
  // Restores the corners that the most flexible model explains.
  std::vector<CameraModelScore> CrossValidateCameraModel(std::optional<CameraModel> wanted);
  std::map<CameraId, EstimatedCamera> EstimateCameras() const;

  // Adds the scale bars that agree with each other. If they contradict the markers, widens the
  // prior of the print's scale accordingly. Returns false if there are no such bars.
  bool AddScaleBars();

  // Minimizes with the sizes. Removes corners beyond outlier_sigmas and restores those that have
  // come to fit, until nothing changes.
  void AdjustWithSizes();

  // Counts markers less that move relative to the others (moving_markers.h), and adjusts with the
  // sizes again.
  void AllowForMotion();

  // Minimizes until steps are a small fraction of a sigma, then computes the correlation of errors,
  // the covariance, and the warnings and figures of the summary. Corrects the image points for the
  // rolling shutter (MoveToMiddleRow()).
  void Finish();
  // After Finish: uses the jackknife's sigmas for the cameras where they are larger.
  void WidenCameraSigmas();

  // With the image points where they would be at the time of the middle row, as after Finish().
  Model ModelAtMiddleRow() const;
  Model TakeModel() { return std::move(solution_.model); }
  MarkerAdjustmentSummary TakeSummary();

 private:
  // Where each adjustment begins.
  struct Seed {
    MarkerSolution solution;
    MarkerAdjustmentSummary summary;
  };

  void RestoreSeed();
  // The steps of an adjustment: loose sizes, bent markers (bent_markers.h), contradicting sizes,
  // sizes.
  void AdjustToCorners();
  // Minimizes with hardly any weight on the markers' sizes, so that the images decide, and
  // calibrates the corners' sigmas by the residuals.
  void AdjustWithLooseSizes();
  // Drops the size of markers that contradict the others, raises the print tolerance where the
  // sizes scatter more than it explains, and lets each part have a scale of its own where parts
  // disagree.
  void RejectContradictingSizes();
  // Returns the model with the corners that were removed from it. `lost` gets those whose points or
  // images are gone.
  Model WithRemovedCorners(std::vector<RemovedObservation>* lost) const;
  // Returns the number of corners that were removed or restored.
  int ReviseCorners();
  void RemoveUnderconstrainedParts();

  Seed seed_;
  MarkerSolution solution_;
  std::size_t num_images_before_;
  std::string part_disagreement_;  // beginning of a warning; empty if parts agree
  MarkerAdjustmentSummary summary_;
  // With find_camera, after Finish(): the model whose image points are not yet corrected for the
  // rolling shutter.
  Model as_recorded_;
};

}  // namespace velamap
