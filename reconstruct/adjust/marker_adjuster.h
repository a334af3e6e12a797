// The steps of a marker-aware bundle adjustment, which AdjustWithMarkers calls in this order.

#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/problem/corner_residuals.h"
#include "reconstruct/problem/marker_problem.h"
#include "reconstruct/problem/normal_equations.h"

namespace velamap {

class MarkerAdjuster {
 public:
  // All arguments but the model must outlive the adjuster.
  MarkerAdjuster(const MarkerAdjustmentOptions& options, const Layout& layout,
                 const CornerSigmas& corner_sigmas, Model model);

  // Removes outliers of the seed and underconstrained images and points, scales the model to metres
  // by the median of the marker sides and moves the world to the first image's camera. Throws
  // DataError where too little is left.
  void PrepareSeed();

  // Minimizes with hardly any weight on the markers' sizes, so that the images decide, and
  // calibrates the corners' sigmas by the residuals.
  void AdjustLoosely();

  // Drops the size of markers that contradict the others, raises the print tolerance where the
  // sizes scatter more than it explains, and lets each part have a scale of its own where parts
  // disagree.
  void RejectContradictingSizes();

  // Minimizes with the sizes. Removes corners beyond outlier_sigmas and restores those that have
  // come to fit, until nothing changes.
  void AdjustTightly();

  // The three steps above.
  void AdjustToCorners();

  // Where intrinsics that the images determine better than the calibration explain the corners
  // significantly better: the result of AdjustToCorners with these, else nothing. After
  // AdjustToCorners; `begin` is this adjuster before it.
  std::optional<MarkerAdjuster> WithBetterCalibration(MarkerAdjuster begin) const;

  // Adds the scale bars that agree with each other; where they contradict the markers, frees the
  // scale of the print as far as that needs. Returns false where there are none.
  bool AddScaleBars();

  // Minimizes to a small fraction of a sigma, then finds the correlation of errors, the covariance,
  // and the warnings and figures of the summary.
  void Finish();

  Model TakeModel() { return std::move(model_); }
  MarkerAdjustmentSummary TakeSummary() { return std::move(summary_); }

 private:
  // The problem at one state, without loss. `problem` refers to `state`, so it must not be copied.
  struct Linearization {
    MarkerState state;
    MarkerProblem problem;
    MarkerJacobian jacobian;
    MarkerCovariance covariance;
  };

  MarkerProblem MakeProblem(const MarkerWeights& weights, const Model& model, MarkerState* state);
  MarkerState MakeState(const Model& model) const;
  void Minimize(double function_tolerance);
  // Throws DataError where a combination of parameters is undetermined.
  std::unique_ptr<const Linearization> Linearize();
  std::vector<CornerResidual> EvaluateCornersOf(const Model& model);
  // Frees parameters of all cameras, with a prior around their calibration.
  void Free(const FreeIntrinsics& free, double sigma);
  // What freeing some intrinsics brings.
  struct IntrinsicsVerdict {
    double improvement = 0.0;   // of the sum of squares
    double criterion = 0.0;     // what is significant for the number of parameters
    double needed = 0.0;        // the same with errors that corners have in common
    FreeIntrinsics determined;  // clearly better than by the calibration

    bool IsSignificant() const { return improvement > needed; }
  };

  // `sigma` is that of the prior, options_ have that of a calibration.
  IntrinsicsVerdict JudgeIntrinsics(const FreeIntrinsics& free, double sigma) const;
  // The intrinsics that the images determine and that explain the corners significantly better.
  FreeIntrinsics ChooseIntrinsics(double sigma) const;
  // Holds the distortion at the calibration where it has come to fold over. Returns whether it did.
  bool HoldFoldedDistortion();
  // Sum of the squares of all residuals, in sigmas.
  double SumOfSquares();
  // Sets the factor of the corners' sigmas by the median residual; returns the relative change.
  double CalibrateRobustly();
  // Returns the number of corners that were removed or restored.
  int ReviseCorners();
  void RemoveUnderconstrainedParts();
  // Minimizes and sets the factor of the corners' sigmas by the sum of squares until it is stable.
  // Sets the variance factor and the share of large residuals.
  std::unique_ptr<const Linearization> CalibrateCorners();

  MarkerAdjustmentOptions options_;
  const Layout& layout_;
  const CornerSigmas& corner_sigmas_;
  std::map<CameraId, Camera> calibration_;
  const std::size_t num_images_before_;
  Model model_;
  MarkerState state_;  // the last solution, with inset, print scale and velocities
  MarkerWeights weights_;
  std::string part_disagreement_;  // begin of a warning; empty where parts agree
  MarkerAdjustmentSummary summary_;
};

}  // namespace velamap
