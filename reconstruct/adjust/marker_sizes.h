// The sizes of the reconstructed markers: the initial scale, markers whose size contradicts the
// others, scale bars that contradict the markers.

#pragma once

#include <set>
#include <string>
#include <vector>

#include "reconstruct/adjust/marker_problem.h"
#include "reconstruct/adjust/normal_equations.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// Metres per unit of the state: the median over all sides of printed / reconstructed length. Throws
// DataError where no side has both corners.
double MedianScale(const MarkerState& state);

struct MarkerSizeVerdict {
  std::set<int> contradicting;   // marker ids
  double print_tolerance = 0.0;  // the given one, or a larger one where the markers scatter more
  std::vector<std::string> warnings;
};

// Compares the mean side of each marker with the median of all markers. `covariance` belongs to a
// solution in which the sizes had hardly any weight. A marker contradicts the others if it deviates
// by more than four sigmas of image noise and print tolerance together. If ten or more markers
// scatter 1.3 times as far as these sigmas explain, the print tolerance is raised.
MarkerSizeVerdict JudgeMarkerSizes(const MarkerState& state, const MarkerCovariance& covariance,
                                   double print_tolerance);

// The scale bars of the layout whose corners are in the state.
std::vector<ScaleBar> FindScaleBars(const MarkerState& state, const Layout& layout);

// Derivative of the bar's length by the coordinates of all points, 3n.
Eigen::VectorXd BarGradient(const ScaleBar& bar, const MarkerState& state);

// A warning where bar and markers differ by more than four sigmas of both together; else empty.
std::string FindContradiction(const ScaleBar& bar, const MarkerState& state,
                              const PointCovariance& points);

}  // namespace velamap
