// The marker-aware bundle adjustment as a least-squares problem for Ceres.

#pragma once

#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include <ceres/problem.h>

#include "importer/layout/layout.h"
#include "reconstruct/problem/corner_errors.h"
#include "reconstruct/problem/marker_adjustment_options.h"
#include "reconstruct/problem/marker_state.h"

namespace velamap {

// Weights that change from one minimization to the next.
struct MarkerWeights {
  double corner_factor = 1.0;  // multiplies the sigmas of all corners
  // Of the errors of two corners of a marker in one image, along the same coordinate.
  double corner_correlation = 0.0;
  // Multiply those of single markers, which move relative to the others (MotionFactors()).
  std::map<int, double> marker_factors;
  double loss_sigmas = 0.0;
  double print_tolerance = 0.0;
  // 1 sigma of the relative scale error caused by an inset that is not estimated.
  double inset_as_scale = 0.0;
  // 1 sigma of the relative scale error that is left by the chords of markers on curved surfaces.
  double chords_as_scale = 0.0;
  // 1 sigma of the scale of the print, as a fraction, that a contradiction between scale bars and
  // markers requires; 0 without a contradiction.
  double print_scale_by_bars = 0.0;
  // The readout time is a parameter instead of an option.
  bool frees_rolling_shutter = false;
  // 1 sigma of the scale of each part's prints around the scale of all; 0: parts agree.
  double part_scale_sigma = 0.0;
  // Without scale bars, only its prior determines the scale of the print. It is then held constant
  // during the minimization, because it would slow down the convergence, and freed for the
  // covariance.
  bool holds_print_scale = false;
  std::set<int> markers_without_size;
  // Each state resolves them anew, because corners and markers are removed between minimizations.
  std::vector<KnownDistance> scale_bars;
};

// 1 sigma of the scale of the print as a whole, as a fraction.
double PrintScaleSigma(const MarkerAdjustmentOptions& options, const MarkerWeights& weights);

struct MarkerProblem {
  std::unique_ptr<ceres::Problem> ceres = std::make_unique<ceres::Problem>();
  // Parameters that vary, in the order of their columns: markers, then the global ones (poses,
  // intrinsics, rolling shutter, inset, print scale, scales of parts).
  std::vector<double*> marker_blocks;
  std::vector<double*> global_blocks;
  // One marker of each pair that a scale bar couples: the Schur complement must not eliminate both.
  std::set<double*> kept_markers;
  std::vector<ceres::ResidualBlockId> corner_residuals;
  std::vector<ceres::ResidualBlockId> prior_residuals;  // all others but scale bars
  // One for every pair of residuals of corner_residuals, in order.
  std::vector<std::pair<Point3DId, TrackElement>> corners;
  std::vector<double> corner_sigmas_px;  // by `corners`
  double corner_correlation = 0.0;       // see MarkerWeights

  // The corners' residuals, then the priors'.
  std::vector<ceres::ResidualBlockId> ResidualsWithoutBars() const {
    std::vector<ceres::ResidualBlockId> residuals = corner_residuals;
    residuals.insert(residuals.end(), prior_residuals.begin(), prior_residuals.end());
    return residuals;
  }
};

// Refers to `state`, which must outlive the problem. `calibration` is the prior of the cameras. The
// corners' sigmas follow from `options` and `corner_errors`, times the factor of `weights`.
MarkerProblem MakeMarkerProblem(const MarkerAdjustmentOptions& options, const Model& model,
                                const CornerErrors& corner_errors,
                                const std::map<CameraId, Camera>& calibration,
                                const MarkerWeights& weights, MarkerState* state);

// Minimizes until a step changes the cost by less than the fraction `function_tolerance`. Returns
// the number of iterations. Throws DataError if no step can be computed.
int MinimizeMarkerProblem(int max_num_iterations, double function_tolerance,
                          MarkerProblem* problem);

// Residuals of the corners, two for every entry of `corners`.
std::vector<double> CornerResiduals(const MarkerProblem& problem);

}  // namespace velamap
