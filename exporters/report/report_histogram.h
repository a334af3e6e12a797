// Histograms with round bin borders, as the report draws them.

#pragma once

#include <vector>

namespace velamap {

struct Histogram {
  double first_border = 0.0;  // lower border of the first bin, a multiple of bin_width
  double bin_width = 0.0;     // 1, 2 or 5 times a power of ten
  std::vector<int> counts;    // a value on a border counts to the bin above it
  // Values too far out for a bin: a few strays shall not squeeze all others into one.
  int num_below = 0;
  int num_above = 0;
};

// At most 32 bins around the values that lie within six robust sigmas of the median. Values that
// are not finite are left out; no bins for no values.
Histogram MakeHistogram(std::vector<double> values);

}  // namespace velamap
