// Histograms with round bin borders for the report.

#pragma once

#include <vector>

namespace velamap {

struct Histogram {
  double first_border = 0.0;  // lower border of the first bin, a multiple of bin_width
  double bin_width = 0.0;     // 1, 2 or 5 times a power of ten
  std::vector<int> counts;    // a value on a border counts for the bin above it
  // Outliers have no bin, so that they do not squeeze all other values into one.
  int num_below = 0;
  int num_above = 0;
};

// Makes at most 32 bins for the values within six robust sigmas of the median. Ignores values that
// are not finite; returns no bins without values.
Histogram MakeHistogram(std::vector<double> values);

}  // namespace velamap
