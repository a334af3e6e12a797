// Whether the parts of the layout agree on the size of their markers.

#pragma once

#include <string>
#include <vector>

#include "reconstruct/sizes/size_deviations.h"

namespace velamap {

struct PartsVerdict {
  // 1 sigma of the scale, as a fraction, if the parts disagree, from how far they are from each
  // other; 0 if they agree.
  double scale_sigma = 0.0;
  std::string disagreement;  // "sail and hull disagree by ..."; empty if the parts agree
};

// The parts disagree if one of them differs from the weighted mean of the others by more than
// kMaxSizeSigmas and by more than `print_scale_sigma`, 1 sigma of the scale of the print as a
// fraction. Parts with fewer than kMinMarkersOfPart markers do not take part. The inset of the
// corners may differ between parts by as much as it is uncertain. `print_tolerance` is 1 sigma of a
// printed side, as a fraction.
PartsVerdict JudgeParts(const std::vector<MarkerSize>& sizes, double print_tolerance,
                        double print_scale_sigma);

}  // namespace velamap
