// What the steps of a marker-aware bundle adjustment pass on to each other, and the minimization
// that they share.

#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "importer/layout/layout.h"
#include "reconstruct/geometry/intrinsics_prior.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"
#include "reconstruct/problem/corner_errors.h"
#include "reconstruct/problem/corner_residuals.h"
#include "reconstruct/problem/marker_adjustment_options.h"
#include "reconstruct/problem/marker_chords.h"
#include "reconstruct/problem/marker_problem.h"
#include "reconstruct/problem/normal_equations.h"

namespace velamap {

struct MarkerSolution {
  MarkerAdjustmentOptions options;
  const Layout* layout = nullptr;
  const CornerErrors* corner_errors = nullptr;
  std::map<CameraId, Camera> calibration;  // the prior of the cameras where they are refined
  Model model;
  // The result of the last minimization. The next one starts at its rolling shutter, inset and
  // print scale.
  MarkerState state;
  MarkerWeights weights;
  std::map<int, MarkerChords> chords;  // by marker id; none: flat
  // Whether the free intrinsics come from SetFreeIntrinsics() and not from the user's options.
  bool has_chosen_intrinsics = false;
  int num_iterations = 0;  // of all minimizations
  std::vector<std::string> warnings;
};

// The problem at a solution, without loss. `problem` refers to `state`, so it must not be copied.
struct MarkerLinearization {
  MarkerState state;
  MarkerProblem problem;
  MarkerJacobian jacobian;
  MarkerCovariance covariance;
};

// Frees parameters of all cameras. Their prior is the calibration with `sigma`, the fraction that
// MakeIntrinsicsPrior takes.
void SetFreeIntrinsics(const FreeIntrinsics& free, double sigma, MarkerSolution* solution);

// Minimizes until a step changes the cost by less than the fraction `function_tolerance`. A refined
// distortion that folds over inside the image is held at the calibration, with a warning; if the
// user's options free it, throws InputError. Throws DataError if no step can be computed.
void Minimize(double function_tolerance, MarkerSolution* solution);

// Throws DataError if a combination of parameters is undetermined.
std::unique_ptr<const MarkerLinearization> Linearize(const MarkerSolution& solution);

// CorrelationFactor() for groups of neighbouring images.
double ShapeCorrelationFactor(const MarkerSolution& solution,
                              const MarkerLinearization& linearization);

// The same factor for the sizes of the markers.
double SizeCorrelationFactor(const MarkerSolution& solution,
                             const MarkerLinearization& linearization);

// 1 sigma, in s, of the readout time (from the first row to the last), which must be a free
// parameter. It is larger than `independent_sigma_s`, the sigma from independent errors of the
// corners: cloth that moves between two frames looks like a rolling shutter, all corners of an
// image share errors of their velocity, the scatter of a few groups of images is itself uncertain
// (Student's t), and compression shortens the time.
double ShutterSigma(double independent_sigma_s, const MarkerSolution& solution,
                    const MarkerLinearization& linearization);

// Everything but the variance factor, the correlation factor and the share of large residuals.
AdjustmentUncertainty UncertaintyOf(const MarkerSolution& solution,
                                    const MarkerLinearization& linearization);

// Residuals of the corners of another model with the weights of the solution, without loss.
std::vector<CornerResidual> ResidualsOfModel(const Model& model, const MarkerSolution& solution);

// MotionFactors() of the corners of another model with the weights of the solution.
std::map<int, double> MotionFactorsOf(const Model& model, const MarkerSolution& solution);

// Sum of the squares of all residuals in sigmas, as reduced by the loss.
double SumOfSquares(const MarkerSolution& solution);

// The decrease of SumOfSquares() that is significant for `num_parameters` more parameters: the
// Bayesian information criterion (Schwarz, "Estimating the Dimension of a Model", 1978).
double InformationCriterion(int num_parameters, const MarkerSolution& solution);

}  // namespace velamap
