// Whether markers on a curved surface bend with it or are stiff plates. A marker that bends changes
// its outline: of its sides and diagonals, those along the bend become chords, the others stay.

#pragma once

#include <map>

#include <Eigen/Core>

#include "reconstruct/problem/marker_adjustment_options.h"
#include "reconstruct/problem/marker_state.h"
#include "reconstruct/problem/normal_equations.h"

namespace velamap {

struct BendEvidence {
  // The observed change of the outlines as a fraction of that predicted from the curvature: 1 if
  // all markers bend with their surface, 0 if they are stiff.
  double share = 0.0;
  double sigma = 0.0;  // infinite without any markers
};

// Only the proportions of each marker count, not its size. `covariance` must come from a solution
// in which the printed sizes had hardly any weight; `curvatures_1_m` is as in ChordSummary. The
// sigma contains print_tolerance for each length, and common_print_tolerance for prints whose width
// and height have different scales.
BendEvidence FindBendEvidence(const MarkerState& state, const MarkerCovariance& covariance,
                              const std::map<int, Eigen::Matrix2d>& curvatures_1_m,
                              const MarkerAdjustmentOptions& options);

}  // namespace velamap
