// The outline of a marker that bends with a curved surface.

#pragma once

#include <algorithm>
#include <array>

#include "importer/base/ids.h"

namespace velamap {

struct MarkerChords {
  // Distance between the ends of a side divided by its printed length: of the sides that begin at
  // corners 1 to 4.
  std::array<double, kNumCorners> side_ratios = {1.0, 1.0, 1.0, 1.0};
  // The diagonal from corner 1 to 3 minus that from 2 to 4, divided by the printed side.
  double diagonals_difference = 0.0;

  bool IsFlat() const {
    return std::all_of(side_ratios.begin(), side_ratios.end(),
                       [](double ratio) { return ratio == 1.0; });
  }
};

}  // namespace velamap
