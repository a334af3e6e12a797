// Distances of the layout that take part in the adjustment: which of them agree with each other,
// and the scale of the print that follows from them.

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/layout/layout.h"
#include "reconstruct/problem/marker_state.h"

namespace velamap {

// A known distance, with the weights of corners that ScaleBarError takes.
struct ScaleBar {
  KnownDistance distance;
  std::vector<int> marker_idxs;  // one or two
  std::vector<std::vector<double>> corner_weights;
};

// The scale bars of the layout whose corners are in the state.
std::vector<ScaleBar> FindScaleBars(const MarkerState& state, const Layout& layout);

// Length of the bar in the state, m.
double BarLength(const ScaleBar& bar, const MarkerState& state);

// Derivative of the bar's length by the coordinates of all points, 3n.
Eigen::VectorXd BarGradient(const ScaleBar& bar, const MarkerState& state);

struct ScaleBarVerdict {
  std::vector<ScaleBar> used;
  // By how much the bars in use enlarge a model whose scale comes from the markers. 1 where they do
  // not contradict the markers.
  double scale = 1.0;
  // 1 sigma of the scale of the print that this contradiction needs; 0 without one.
  double print_scale_sigma = 0.0;
  std::vector<std::string> warnings;
};

// Finds the largest set of bars that agree with each other: each is within four sigmas of the scale
// that the others give. Such a set overrules the markers, whose sizes have an error in common that
// no image shows; the others are left out. Where sets are equally large, the one that fits the
// markers counts, and none where none does. A single bar is right about the scale, too, unless it
// is so far off that it must be a mistake.
//
// The state has its scale from the markers. `covariance_m2` is that of the bars' lengths in it
// where the scale of the print is known; `print_scale_sigma` is the prior of that scale.
ScaleBarVerdict JudgeScaleBars(const std::vector<ScaleBar>& bars, const MarkerState& state,
                               const Eigen::MatrixXd& covariance_m2, double print_scale_sigma);

}  // namespace velamap
