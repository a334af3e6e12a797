// Measured distances of the layout between corners of the adjustment.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "importer/layout/layout.h"
#include "reconstruct/problem/marker_state.h"

namespace velamap {

// A known distance, with the weights of corners that ScaleBarError takes. It belongs to one state:
// in another one, the indices of markers and corners differ.
struct ScaleBar {
  KnownDistance distance;
  std::vector<int> marker_idxs;  // one or two
  std::vector<std::vector<double>> corner_weights;
};

// The scale bars among the distances, except those with a corner that the state lacks.
std::vector<ScaleBar> FindScaleBars(const MarkerState& state,
                                    const std::vector<KnownDistance>& distances);

// Length of the bar in the state, m.
double BarLength(const ScaleBar& bar, const MarkerState& state);

// Derivative of the bar's length with respect to the coordinates of all points, 3n.
Eigen::VectorXd BarGradient(const ScaleBar& bar, const MarkerState& state);

}  // namespace velamap
