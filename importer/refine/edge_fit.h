// Least-squares fit of one side of a marker, the fallback of corner_refinement.h.
//
// Around the side, with s in [-1, 1] along it and d the distance outwards from the sampled line,
//
//   I = light - (light - dark) * cover * (1 - step(d - e))
//       + inner_gain * inner * (1 - step(d - e + inner_depth))
//       + outer_gain * outer * step(d - e - outer_depth)
//   e = offset + slope * s + bend * (1 - s^2),   step(x) = Phi(x / blur)
//
// Phi is the normal distribution; dark and light are linear in s. `cover` ends the dark square at
// the neighbouring sides; `inner` and `outer` are the contributions of the cells beyond the border
// and beyond the quiet zone, whose blur reaches the edge when cells are only a few px wide.

#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "importer/lanes/float_lanes.h"
#include "importer/pattern/fit_equations.h"
#include "importer/pattern/refined_corners.h"

namespace velamap {

// A group of pixels near a side.
struct EdgeSampleGroup {
  Floats s;            // -1 and 1 at the side's ends
  Floats distance_px;  // outwards from the sampled line
  Floats gray;
  Floats cover;
  Floats inner;  // grey level of the cell beyond the border, minus dark
  Floats outer;  // grey level beyond the quiet zone, minus light
  Floats inner_depth_px;
  Floats outer_depth_px;
};

constexpr int kMaxEdgeSamples = 512;

struct EdgeSamples {
  std::array<EdgeSampleGroup, kMaxEdgeSamples / kLanes> groups;
  int count = 0;  // of samples; the last group may be incomplete
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

// Prior of each parameter: its most likely value and 1 sigma (infinite without a prior).
struct EdgePrior {
  EdgeParameters mean;
  EdgeParameters sigma;
};

using EdgeEquations = FitEquations<EdgeParameters::kCount>;

struct EdgeFit {
  EdgeParameters parameters;
  EdgeEquations equations;  // near the minimum
};

// Grey levels of the model at a group of samples, and their derivatives with respect to the
// parameters.
Floats EvaluateEdge(const EdgeParameters& parameters, const EdgeSampleGroup& samples,
                    EdgeEquations::Jacobian* jacobian);

// Levenberg-Marquardt from the prior's mean until a step moves the edge no further than
// `tolerance_px`. Returns false with too few samples or a singular system.
bool FitEdge(const EdgeSamples& samples, const EdgePrior& prior, double tolerance_px, EdgeFit* fit);

struct EdgeUncertainty {
  // Covariance of offset and slope (px^2) for noise of one grey level.
  Eigen::Matrix2d place_covariance = Eigen::Matrix2d::Zero();
  ResidualNoise noise;
};

// At the minimum that FitEdge() found. The priors stabilize weak parameters but are not
// observations, so that their own error does not count. Returns nothing for a singular system.
std::optional<EdgeUncertainty> EstimateUncertainty(const EdgeFit& fit, const EdgePrior& prior);

}  // namespace velamap
