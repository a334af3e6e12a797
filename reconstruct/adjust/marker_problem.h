// The marker-aware bundle adjustment as a least-squares problem: parameters, weights, residual
// blocks. Private to this room: it shows Ceres.

#pragma once

#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/adjust/marker_cost_functions.h"
#include "reconstruct/adjust/marker_state.h"
#include "reconstruct/solve/schur_problem.h"

namespace velamap {

// A known distance as weights of corners: ScaleBarError.
struct ScaleBar {
  KnownDistance distance;
  std::vector<int> marker_idxs;  // one or two
  std::vector<std::vector<double>> corner_weights;
};

// What changes from one solution to the next.
struct MarkerWeights {
  double corner_factor = 1.0;  // of all corners' sigmas
  double loss_sigmas = 0.0;
  double print_tolerance = 0.0;
  // What an inset that is not estimated may do to the scale, 1 sigma, as a fraction.
  double inset_as_scale = 0.0;
  // Without scale bars nothing but its prior tells the print's scale: as a parameter it would only
  // keep a solution from its last digits. It is one for the covariance.
  bool holds_print_scale = false;
  std::set<int> markers_without_size;
  std::vector<ScaleBar> scale_bars;
};

struct MarkerProblem {
  std::vector<std::unique_ptr<ceres::CostFunction>> errors;
  std::vector<std::unique_ptr<ceres::Manifold>> manifolds;
  // Blocks: markers in order (eliminated), then all others. Residuals: corners, priors, scale bars.
  SchurProblem schur;
  int num_markers = 0;
  std::vector<int> corner_residuals;  // indices
  std::vector<int> prior_residuals;   // all others but scale bars
  // Residual pairs of corner_residuals, in order.
  std::vector<std::pair<Point3DId, TrackElement>> corners;
};

// Refers to `state`, which must outlive it. `calibration` is the prior of the cameras; sigmas of
// corners as options and `corner_sigmas` say, times the factor.
MarkerProblem MakeMarkerProblem(const MarkerAdjustmentOptions& options, const Model& model,
                                const CornerSigmas& corner_sigmas,
                                const std::map<CameraId, Camera>& calibration,
                                const MarkerWeights& weights, MarkerState* state);

// Minimises to the relative change of the cost `function_tolerance`. Returns the number of
// iterations. One thread: sums over several would depend on their course in the last digits.
int SolveMarkerProblem(int max_num_iterations, double function_tolerance, MarkerProblem* problem);

}  // namespace velamap
