// Plain statistics of a list of numbers, as every report of velamap shows them.

#pragma once

#include <vector>

namespace velamap {

struct Statistics {
  int count = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;  // of the sample, n - 1; 0 for fewer than two
  double median = 0.0;
  double min = 0.0;
  double max = 0.0;
  double rms = 0.0;
};

// All zero for no values.
Statistics ComputeStatistics(std::vector<double> values);

// Median; the mean of the middle two for an even count. `values` must not be empty.
double Median(std::vector<double> values);

// 1.4826 * median absolute deviation from the median: the standard deviation of a normal
// distribution, untouched by up to half of outliers. `values` must not be empty.
double RobustSigma(const std::vector<double>& values);

}  // namespace velamap
