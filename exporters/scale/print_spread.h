// Estimates by how much the black squares of all markers look larger (or smaller) than designed: in
// the print, where ink spreads, and in the images, from blur or the detector. A spread of the print
// is the same length on every marker; a spread of the image grows on the object with the distance
// of the camera.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "importer/base/statistics.h"

namespace velamap {

struct SpreadSample {
  double log_side_ratio = 0.0;  // logarithm of side / printed side
  double sigma = 0.0;           // of log_side_ratio; 0 if unknown
  double length_m = 0.0;        // printed side
  std::optional<double> side_px;
};

// Spreads count outwards from each edge, so a side grows by twice the spread; insets are negative.
struct PrintSpread {
  std::optional<UncertainValue> print_um;
  std::optional<UncertainValue> image_px;
  std::string note;  // which terms are determined, and why others are not
};

// Fits log(side ratio) = scale error + 2 print / length + 2 image / side_px. The terms are
// determined if markers differ in length_m and in side_px. A term that does not vary over the
// markers, or correlates with the other one, gets no value.
PrintSpread EstimateSpread(const std::vector<SpreadSample>& samples);

}  // namespace velamap
