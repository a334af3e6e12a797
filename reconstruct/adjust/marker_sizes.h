// What the reconstructed markers say about their own size: initial scale, markers whose size
// contradicts that of the others, scale bars that contradict the markers. Private to this room.

#pragma once

#include <set>
#include <string>
#include <vector>

#include "reconstruct/adjust/marker_problem.h"
#include "reconstruct/adjust/normal_equations.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// m per unit of the state: median over all sides of printed / reconstructed. Throws DataError
// where no side has both corners.
double MedianScale(const MarkerState& state);

struct MarkerSizeVerdict {
  std::set<int> contradicting;   // markers, by id
  double print_tolerance = 0.0;  // the given one, or more where the markers scatter more
  std::vector<std::string> warnings;
};

// Compares each marker's mean side with the median of all. `covariance` is that of a solution in
// which sizes hardly counted. A marker contradicts beyond four sigmas of image noise and
// tolerance together. Ten markers or more that scatter 1.3 times as far as that tell that
// `print_tolerance` is too small.
MarkerSizeVerdict JudgeMarkerSizes(const MarkerState& state, const MarkerCovariance& covariance,
                                   double print_tolerance);

// The layout's distances that are scale bars and have their corners in the state.
std::vector<ScaleBar> FindScaleBars(const MarkerState& state, const Layout& layout);

// Gradient of the bar's length by all points, 3n.
Eigen::VectorXd BarGradient(const ScaleBar& bar, const MarkerState& state);

// In words, where bar and markers differ by more than four sigmas of both; else empty.
std::string FindContradiction(const ScaleBar& bar, const MarkerState& state,
                              const PointCovariance& points);

}  // namespace velamap
