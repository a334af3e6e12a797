// The sizes of the reconstructed markers: the initial scale, and markers and parts whose size
// contradicts the others.

#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "reconstruct/geometry/point_covariance.h"
#include "reconstruct/problem/marker_problem.h"
#include "reconstruct/problem/normal_equations.h"

namespace velamap {

// Metres per unit of the state: the median, over all sides, of printed / reconstructed length.
// Throws DataError if no side has both corners.
double MedianScale(const MarkerState& state);

struct MarkerSizeVerdict {
  std::set<int> contradicting;   // marker ids
  double print_tolerance = 0.0;  // the given one, or a larger one where the markers scatter more
  // 1 sigma of the parts' scales around their mean, as a fraction; 0 if the parts agree.
  double part_scale_sigma = 0.0;
  std::string part_disagreement;  // "sail and hull disagree by ..."; empty: parts agree
  std::vector<std::string> warnings;
};

// Compares the mean side of each marker with the median of all markers. `covariance` belongs to a
// solution in which the sizes had hardly any weight. `inset_sigmas` gives, by marker id, 1 sigma of
// the marker's size that the inset of its corners causes in all images alike, as a fraction;
// markers that it lacks have none. A marker contradicts the others if it deviates by more than four
// sigmas of image noise, inset and print tolerance together. If ten or more markers scatter 1.3
// times as far as these sigmas explain, the print tolerance is raised.
//
// Parts disagree if the mean of one (of three markers or more) differs from the mean of the others
// by more than four sigmas and by more than `print_scale_sigma`, 1 sigma of the scale of the print.
// Their markers are then no bad prints, and each is compared with its own part. Smaller differences
// would change the scale's sigma by less than an eighth.
MarkerSizeVerdict JudgeMarkerSizes(const MarkerState& state, const MarkerCovariance& covariance,
                                   const std::map<int, double>& inset_sigmas,
                                   double print_tolerance, double print_scale_sigma);

}  // namespace velamap
