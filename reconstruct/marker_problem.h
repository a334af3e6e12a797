// The marker-aware bundle adjustment as a least-squares problem: parameters, weights, residual
// blocks. Private to this room: it shows Ceres.

#pragma once

#include <array>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "reconstruct/marker_adjustment.h"
#include "reconstruct/marker_cost_functions.h"
#include "reconstruct/schur_problem.h"

namespace velamap {

struct MarkerBlock {
  int marker_id = 0;
  std::vector<int> corners;        // 1..4, ascending: those that are in the model
  std::vector<double> x_in_world;  // x y z of each, m
  double length_m = 0.0;           // of the layout
  bool is_rigid = false;
};

struct ImageBlock {
  ImageId image_id = 0;
  CameraId camera_id = 0;
  std::array<double, 7> cam_from_world{};
  std::array<double, 6> velocity{};
};

// All parameters. The first image's pose is the gauge.
struct MarkerState {
  std::vector<MarkerBlock> markers;  // ascending
  std::vector<ImageBlock> images;    // in order of the model
  std::map<CameraId, std::vector<double>> intrinsics;
  double inset_px = 0.0;
  double print_scale = 0.0;
};

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

// Parts of the layout that say which markers are rigid, by marker; and the lengths. Throws
// DataError for a point that is no marker corner.
MarkerState MakeMarkerState(const Model& model, const Layout& layout);

// Poses, points and cameras of the state.
void WriteMarkerState(const MarkerState& state, Model* model);

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
