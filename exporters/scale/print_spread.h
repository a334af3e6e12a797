// How far the black squares look larger (or smaller) than they are meant to be, for all markers
// alike: in the print, by ink that spreads, and in the image, by the detector or blur. A spread of
// the print is the same on every marker, one of the image the larger on the object the farther the
// camera.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/scale/robust_fit.h"

namespace velamap {

struct SpreadSample {
  double log_side_ratio = 0.0;  // logarithm of side / printed side
  double sigma = 0.0;           // of it; 0 where unknown
  double length_m = 0.0;        // printed side
  std::optional<double> side_px;
};

// A figure and its 1 sigma.
struct UncertainValue {
  double value = 0.0;
  double sigma = 0.0;
};

// Outwards from each edge, so that a side is longer by twice the spread; an inset is negative.
struct PrintSpread {
  std::optional<UncertainValue> print_um;
  std::optional<UncertainValue> image_px;
  // By this fraction the sides of markers so large that no spread counts are longer than printed:
  // the shape is too large by it, if the spread is the only error.
  std::optional<UncertainValue> scale_error;
  std::string note;  // what is determined, and why not the rest
};

// log(side ratio) = scale error + 2 print / length + 2 image / side_px. What determines the terms
// is that markers differ in length_m and in side_px; a term that does not vary over the markers, or
// varies with the other, is not told apart and stays without a value.
PrintSpread EstimateSpread(const std::vector<SpreadSample>& samples);

}  // namespace velamap
