// The course of a marker-aware bundle adjustment, one step a function, in this order. Private to
// this room: AdjustWithMarkers runs it.

#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "reconstruct/adjust/marker_problem.h"
#include "reconstruct/adjust/normal_equations.h"

namespace velamap {

class MarkerAdjuster {
 public:
  // The arguments must outlive it, but for the model.
  MarkerAdjuster(const MarkerAdjustmentOptions& options, const Layout& layout,
                 const CornerSigmas& corner_sigmas, Model model);

  // Takes out what stands out in the seed and what nothing determines; brings it to metres (median
  // of the marker sides) in the first camera's frame. Throws DataError where too little is left.
  void PrepareSeed();

  // Markers may be of any size within some percent: what the images alone say, with robust weights
  // and corner sigmas that follow the residuals.
  void AdjustLoosely();

  // Markers whose size contradicts that of the others lose their size; where they scatter more than
  // the tolerance explains, the tolerance grows.
  void JudgeMarkerSizes();

  // With the sizes. Corners beyond outlier_sigmas go and come back until nothing changes.
  void AdjustTightly();

  // Scale bars that agree with the markers take part from now on; false: there are none.
  bool AddScaleBars();

  // Until a step is a small part of a sigma; what errors have in common; covariance, warnings,
  // summary.
  void Finish();

  Model TakeModel() { return std::move(model_); }
  MarkerAdjustmentSummary TakeSummary() { return std::move(summary_); }

 private:
  struct CornerResidual {
    Point3DId point3D_id = 0;
    TrackElement element;
    double sigmas = 0.0;  // length in calibrated sigmas
  };

  // The problem at one state, without loss. Refers to itself, so it stays where it is.
  struct Linearisation {
    MarkerState state;
    MarkerProblem problem;
    MarkerCovariance covariance;
  };

  MarkerProblem MakeProblem(const MarkerWeights& weights, const Model& model, MarkerState* state);
  MarkerState MakeState(const Model& model) const;
  void Solve(double function_tolerance);
  // Throws DataError where a combination of parameters is undetermined.
  std::unique_ptr<const Linearisation> Linearise();
  std::vector<CornerResidual> EvaluateCorners(const Model& model);
  static std::vector<CornerResidual> EvaluateCorners(const MarkerProblem& problem);
  // Sets the corners' factor by the median residual; returns the relative change.
  double CalibrateRobustly();
  int ReviseCorners();
  void RemoveUnderconstrainedParts();
  // Corner sigmas by all residuals, solution, variance factor of the detector's sigmas, share of
  // large residuals.
  std::unique_ptr<const Linearisation> CalibrateCorners();

  const MarkerAdjustmentOptions& options_;
  const Layout& layout_;
  const CornerSigmas& corner_sigmas_;
  const std::map<CameraId, Camera> calibration_;
  const std::size_t num_images_before_;
  Model model_;
  MarkerState state_;  // of the last solution; beyond the model: inset, print scale, velocities
  MarkerWeights weights_;
  MarkerAdjustmentSummary summary_;
};

}  // namespace velamap
