// Which of the measured distances of the layout agree with each other, and the scale of the print
// that follows from them.

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/layout/layout.h"
#include "reconstruct/problem/marker_state.h"
#include "reconstruct/problem/scale_bar.h"

namespace velamap {

struct ScaleBarVerdict {
  std::vector<KnownDistance> used;
  // Factor by which the bars in use enlarge a model whose scale comes from the markers. 1 if they
  // do not contradict the markers.
  double scale = 1.0;
  // 1 sigma of the scale of the print that explains this contradiction; 0 without one.
  double print_scale_sigma = 0.0;
  std::vector<std::string> warnings;
};

// Finds the largest set of bars that agree with each other: each is within four sigmas of the scale
// that the others give. Such a set overrules the markers, because their sizes may have a common
// error that no image shows. The other bars are left out. Of equally large sets, the one that fits
// the markers is used; if none does, no bar is used. A single bar also overrules the markers,
// unless it is so far off that it must be a mistake.
//
// The scale of the state comes from the markers. `covariance_m2` is the covariance of the bars'
// lengths in it for a known scale of the print; `print_scale_sigma` is the prior of that scale.
ScaleBarVerdict JudgeScaleBars(const std::vector<ScaleBar>& bars, const MarkerState& state,
                               const Eigen::MatrixXd& covariance_m2, double print_scale_sigma);

// A warning for each distance in use whose corners have left the state since.
std::vector<std::string> LostScaleBars(const std::vector<KnownDistance>& used,
                                       const MarkerState& state);

}  // namespace velamap
