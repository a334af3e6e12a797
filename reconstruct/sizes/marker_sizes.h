// The sizes of the reconstructed markers. They give the initial scale, and they show which markers
// and parts contradict the others.

#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "reconstruct/problem/marker_adjustment_options.h"
#include "reconstruct/problem/marker_state.h"
#include "reconstruct/problem/normal_equations.h"

namespace velamap {

// The factor from the state's unit to metres: the median over all marker sides of the printed
// length divided by the reconstructed one. Throws DataError if no side has both of its corners.
double MetresPerUnit(const MarkerState& state);

struct MarkerSizeVerdict {
  std::set<int> contradicting;   // marker ids
  double print_tolerance = 0.0;  // the given one, or a larger one if the markers scatter more
  // PartsVerdict::scale_sigma.
  double part_scale_sigma = 0.0;
  std::string part_disagreement;  // "sail and hull disagree by ..."; empty if the parts agree
  std::vector<std::string> warnings;
};

// Compares the mean side of each marker with the median of all markers. `covariance` must come from
// a solution in which the printed sizes had hardly any weight. Its sigmas grow by
// `correlation_factor`, because errors that neighbouring images have in common, above all a motion
// of the markers, would otherwise pass for errors of the print. `inset_sigmas` holds, by marker id,
// the sigma of the marker's size that is due to the inset of its corners, which is the same in all
// images; it is a fraction, and 0 for ids that it lacks. The options give 1 sigma of a printed
// side: `print_tolerance` and `print_resolution_m`. A marker contradicts the others if it deviates
// by more than four sigmas of image noise, inset and print tolerance together and two thirds of the
// markers agree. The print tolerance is raised where the markers scatter more (JudgeDeviations()).
// With fewer than three markers nothing is judged.
//
// Parts disagree if the mean of one part (of three markers or more) differs from the mean of the
// others by more than four sigmas and by more than `print_scale_sigma`, 1 sigma of the scale of the
// print as a fraction. The parts were then printed at different scales, which is no fault of their
// markers, so each marker is compared with its own part. Differences below `print_scale_sigma` are
// ignored because they would change the sigma of the scale by less than an eighth.
MarkerSizeVerdict JudgeMarkerSizes(const MarkerState& state, const MarkerCovariance& covariance,
                                   double correlation_factor,
                                   const std::map<int, double>& inset_sigmas,
                                   const MarkerAdjustmentOptions& options,
                                   double print_scale_sigma);

}  // namespace velamap
