// Least-squares fit of one side of a marker: the inner step of corner_refinement.h.
//
// Around the side, with s in [-1, 1] along it and d the distance outwards from the sampled line,
//
//   I = light - (light - dark) * cover * (1 - step(d - e))
//       + inner_gain * inner * (1 - step(d - e + inner_depth))
//       + outer_gain * outer * step(d - e - outer_depth)
//   e = offset + slope * s + bend * (1 - s^2),   step(x) = Phi(x / blur)
//
// Phi is the normal distribution; dark and light are linear in s. `cover` lets the neighbouring
// sides end the dark square; `inner` and `outer` are what the cells beyond the border and beyond
// the quiet zone add, whose blur reaches the edge when cells are only a few px wide.

#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "importer/refined_corners.h"

namespace velamap {

struct EdgeSample {
  double s = 0.0;            // -1 and 1 at the side's ends
  double distance_px = 0.0;  // outwards from the sampled line
  double gray = 0.0;
  double cover = 1.0;
  double inner = 0.0;  // grey level of the cell beyond the border, less dark
  double outer = 0.0;  // grey level beyond the quiet zone, less light
  double inner_depth_px = 0.0;
  double outer_depth_px = 0.0;
};

constexpr int kMaxEdgeSamples = 512;

struct EdgeSamples {
  std::array<EdgeSample, kMaxEdgeSamples> values;
  int count = 0;
};

struct EdgeParameters {
  enum Index {
    kOffset,
    kSlope,
    kBend,
    kBlur,
    kDark,
    kLight,
    kDarkSlope,
    kLightSlope,
    kInnerGain,
    kOuterGain,
    kCount
  };
  using Vector = Eigen::Matrix<double, kCount, 1>;
  Vector values = Vector::Zero();

  double operator[](Index index) const { return values[index]; }
  double& operator[](Index index) { return values[index]; }
  double Contrast() const { return values[kLight] - values[kDark]; }
};

// What is known beforehand: each parameter's most likely value and how far it strays from it
// (1 sigma; infinite where nothing is known).
struct EdgePrior {
  EdgeParameters mean;
  EdgeParameters sigma;
};

struct EdgeFit {
  EdgeParameters parameters;
  double rms_gray = 0.0;  // of the residuals
};

// Grey value of the model at a sample, and its derivatives by the parameters.
double EvaluateEdge(const EdgeParameters& parameters, const EdgeSample& sample,
                    EdgeParameters::Vector* jacobian);

// Levenberg-Marquardt from the prior's mean until a step moves the edge no further than
// `tolerance_px`. Nothing with too few samples or a singular system.
std::optional<EdgeFit> FitEdge(const EdgeSamples& samples, const EdgePrior& prior,
                               double tolerance_px);

// How well noise lets the place of a fitted edge be known.
struct EdgeUncertainty {
  // Covariance of offset and slope (px^2) for noise of one grey level.
  Eigen::Matrix2d place_covariance;
  ResidualNoise noise;
};

// At the minimum that FitEdge() found. The priors hold weak parameters but are no observations:
// their own error does not count. Nothing for a singular system.
std::optional<EdgeUncertainty> EstimateUncertainty(const EdgeSamples& samples,
                                                   const EdgePrior& prior,
                                                   const EdgeParameters& parameters);

}  // namespace velamap
