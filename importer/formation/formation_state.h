// The image formation that the estimate has reached, and all samples fitted with it.

#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "importer/formation/fit_workers.h"
#include "importer/formation/fitted_sample.h"

namespace velamap {

// Indices of a FormationVector.
enum FormationIndex {
  kLogGamma,
  kSAmplitude,
  kSharpening,
  kLogRadius,
  kInkSpread,
  kEdgeShift,
  kHalo,
  kLogHaloRadius,
  kNumFormationParameters
};
constexpr double kMaxEdgeShift = 1.0;  // blur sigmas, either way
using FormationVector = Eigen::Matrix<double, kNumFormationParameters, 1>;

// The parameters that all samples share, and the samples fitted with them.
struct FormationState {
  FormationVector parameters;
  double side_mm = 0.0;  // the unit of the ink spread in `parameters`: a usual side of the markers
  std::shared_ptr<const ImageFormation> formation;
  std::vector<FittedSample> samples;
  // The states after a step of each parameter alone, for derivatives by differences; null until
  // they are needed.
  mutable std::shared_ptr<const std::vector<FormationState>> moved;
};

// The samples fitted with `formation`, which gets the parameters `start`; `side_mm` as in the
// state. Samples that cannot be fitted are left out.
FormationState FitSamples(const std::vector<FormationSample>& samples, const FormationVector& start,
                          double side_mm, const ImageFormationParameters& formation,
                          const FitWorkers& workers);

// The same samples fitted with another image formation, which has these `parameters`.
FormationState FittedWith(const ImageFormationParameters& formation,
                          const FormationVector& parameters, const FormationState& state,
                          const FitWorkers& workers);

// The same samples fitted with other parameters of the vector.
FormationState MovedTo(const FormationVector& parameters, const FormationState& state,
                       const FitWorkers& workers);

// Widths of the quiet zones of all samples, cells.
std::vector<double> QuietZones(const FormationState& state);

// All samples together determine the width of the quiet zone where each alone is too small to do
// so: the prior moves to the median until it no longer changes.
FormationState WithPooledQuietZone(FormationState state, const FitWorkers& workers);

// Robust standard deviation of the residuals at straight edges and within cells, grey levels;
// infinite without any.
double NoiseOf(const FormationState& state);

// The same of each sample alone.
std::vector<double> NoisesOf(const FormationState& state);

// Weight of the pixels at the corners of outlines: the squared ratio of the noise of the other
// pixels to theirs, at most 1.
double OutlineCornerWeight(const FormationState& state);

FormationState WithOutlineCorners(double weight, const FormationState& state,
                                  const FitWorkers& workers);

// Whether a sample has been fitted in both states, and found about the same corners: a fit can jump
// to another minimum, whose difference from the first is no derivative.
bool AreAlike(const FittedSample& one, const FittedSample& other);

// How much farther inside their markers the corners are in `one` than in `other`, along both sides:
// the mean over the samples that are alike in both, px. Both must hold the same samples.
double MeanInset(const FormationState& one, const FormationState& other);

}  // namespace velamap
