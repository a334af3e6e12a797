// Which of the measured distances of the layout agree with each other, and the scale of the print
// that follows from them.

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "reconstruct/problem/marker_state.h"
#include "reconstruct/problem/scale_bar.h"

namespace velamap {

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
