// Bundle adjustment of our own, in Ceres, that knows what the points are: corners of squares of
// known size, printed with some tolerance on cloth that bends a little or on something rigid. The
// result is metric.

#pragma once

#include <map>
#include <optional>
#include <vector>

#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct MarkerAdjustmentOptions {
  // Of a coordinate of a corner where the detector gives none, px.
  double corner_sigma_px = 0.1;
  // Added to every corner's own sigma (root of the sum of squares), px: what neither noise nor the
  // fit sees, as lens residue and print of the edge.
  double corner_sigma_floor_px = 0.02;
  // Cauchy loss: residuals beyond this many sigmas lose weight.
  double loss_sigmas = 3.0;
  // Corners beyond this many (calibrated) sigmas are left out in the end.
  double outlier_sigmas = 4.0;
  // 1 sigma of every printed side against marker_length, independent between sides, as a fraction;
  // root two times that for the difference of a marker's diagonals. Grows where the markers scatter
  // more.
  double print_tolerance = 1e-3;
  // 1 sigma common to all sides (printer, shrinking paper), as a fraction. Nothing in the images
  // tells it: it is all but added to the scale's sigma.
  double common_print_tolerance = 1e-3;
  // 1 sigma of a corner's distance from the plane of its marker, as a fraction of the side. On
  // cloth by its bend, on parts that the layout calls rigid by `rigid_flatness`. 0: no such
  // knowledge.
  double cloth_flatness = 0.01;
  double rigid_flatness = 1e-3;
  // 1 sigma of an error that all corners have in common: seen too far inside (or outside) by so
  // many px along both of the marker's sides. It widens the scale's sigma, by the size of the
  // markers in the images. With estimate_inset it is a parameter with this prior instead, told from
  // the scale by markers that are seen small and large, oblique and straight. What else depends on
  // these passes for an inset too: on a rendered sail 0.031 +- 0.006 px are found where the truth
  // says 0.013 px, and the scale gets worse. 0: no such error.
  double inset_sigma_px = 0.01;
  bool estimate_inset = false;
  bool refine_focal_length = false;  // with the calibration as prior:
  bool refine_principal_point = false;
  bool refine_extra_params = false;
  double intrinsics_sigma = 0.01;  // of a focal length as a fraction; of the principal point as a
                                   // fraction of the focal length; absolute of the others
  // Rows are read one after another over this time; the camera moves meanwhile. 0: not modelled.
  double rolling_shutter_s = 0.0;
  int max_num_iterations = 100;
  int min_track_length = 2;
  double max_mean_error_px = 5.0;
  int num_threads = 0;  // 0: one a core; never changes the result

  void Check() const;  // throws InputError that names the option (--MarkerAdjustment.NAME)
};

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
