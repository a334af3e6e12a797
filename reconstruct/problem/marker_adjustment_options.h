// Options of the marker-aware bundle adjustment, marker_adjustment.h.

#pragma once

#include "importer/base/option.h"
#include "reconstruct/geometry/intrinsics_prior.h"

namespace velamap {

enum class BentMarkers {
  kAuto,  // their proportions and the residuals decide where it matters
  kStiff,
  kBent,
};

struct MarkerAdjustmentOptions {
  // 1 sigma of a corner's coordinate where the detector gives none, px.
  double corner_sigma_px = 0.1;
  // Added to every corner's own sigma (root of the sum of squares), px: lens residue and blurred
  // print, which neither the noise nor the fit of the corner shows.
  double corner_sigma_floor_px = 0.02;
  // Cauchy loss: residuals beyond this many sigmas lose weight.
  double loss_sigmas = 3.0;
  // Corners beyond this many (calibrated) sigmas are left out in the end.
  double outlier_sigmas = 4.0;
  // 1 sigma of every printed side relative to marker_length, independent between sides, as a
  // fraction; sqrt(2) times that for the difference of a marker's diagonals. It grows where the
  // sizes of the markers scatter more.
  double print_tolerance = 1e-3;
  // Added to it (root of the sum of squares): 1 sigma of a printed side that does not depend on its
  // length, m. Edges snap to a printer's dots, which are 0.04 mm apart at 600 dpi.
  double print_resolution_m = 2e-5;
  // 1 sigma of an error that all sides share (printer, shrinking paper), as a fraction. The images
  // do not contain it, so nearly all of it is added to the scale's sigma. Measured distances that
  // contradict it widen it.
  double common_print_tolerance = 1e-3;
  // 1 sigma of a corner's distance from the plane of its marker, as a fraction of the side: on
  // cloth, which bends, and on parts that the layout calls rigid. 0: unknown.
  double cloth_flatness = 0.01;
  double rigid_flatness = 1e-3;
  // Whether the markers bend with the surface that they are on, so that their corners are closer to
  // each other than printed (marker_curvature.h).
  BentMarkers bent_markers = BentMarkers::kAuto;
  // 1 sigma of an error that all corners share, px: each is seen this far inside (or outside) its
  // marker along both sides. It widens the scale's sigma according to the size of the markers in
  // the images. It is added (root of the sum of squares) to what the estimated image formation
  // leaves open.
  double inset_sigma_px = 0.0;
  // Estimates that error, with both sigmas as its prior. Markers that are seen small and large,
  // obliquely and head-on distinguish it from the scale. Every other effect that depends on size
  // and slant is attributed to it as well: on a rendered sail, 0.031 +- 0.006 px are found where
  // the truth is 0.013 px, and the scale gets worse.
  bool estimate_inset = false;
  // The calibration is the prior of refined parameters. Of the extra parameters, only those that
  // the calibration gives are refined.
  bool refine_focal_length = false;
  bool refine_principal_point = false;
  bool refine_extra_params = false;
  // If none of these is set: refine what the images determine clearly better than the calibration,
  // if that explains the corners significantly better.
  bool refine_calibration = true;
  // As a fraction, see MakeIntrinsicsPrior.
  double intrinsics_sigma = 0.01;
  // The cameras are unknown: refine all parameters, with the prior of an unknown camera
  // (UnknownCameraPrior) in place of the calibration.
  bool find_camera = false;
  // Readout time, from the first row of a frame to the last. Corners move meanwhile, with a
  // velocity that the neighbouring frames show. Negative: rows are read from the bottom up. In
  // portrait frames, columns are read from left to right, or from right to left if negative. 0:
  // unknown.
  double rolling_shutter_s = 0.0;
  // Estimate that time if it is unknown and the frames determine it.
  bool estimate_rolling_shutter = true;
  int max_num_iterations = 100;
  int min_track_length = 2;
  double max_mean_error_px = 5.0;
  int num_threads = 0;  // 0: one per core; never changes the result

  void Check() const;  // throws InputError that names the option
};

FreeIntrinsics FreeIntrinsicsOf(const MarkerAdjustmentOptions& options);

// All but the members that BundleAdjustmentOptions also has: one option sets both.
OptionGroup DescribeOptions(MarkerAdjustmentOptions* options);

}  // namespace velamap
