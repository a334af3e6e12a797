// Statistics of a list of numbers, as the reports show them.

#pragma once

#include <cstddef>
#include <optional>
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

  double MaxAbs() const;  // the largest absolute value
};

// A value and its 1 sigma, which can be unknown.
struct Estimate {
  double value = 0.0;
  std::optional<double> sigma;
};

// A value and its 1 sigma.
struct UncertainValue {
  double value = 0.0;
  double sigma = 0.0;

  operator Estimate() const { return {value, sigma}; }
};

// All zero for no values.
Statistics ComputeStatistics(std::vector<double> values);

// The mean of the middle two for an even count. `values` must not be empty.
double Median(std::vector<double> values);

// Medians of chi-squared with 2 and 8 degrees of freedom.
inline constexpr double kChiSquaredMedian2 = 1.386, kChiSquaredMedian8 = 7.344;

// The standard deviation of a normal distribution whose median absolute deviation is 1.
constexpr double kMadToSigma = 1.4826;

// kMadToSigma times the median absolute deviation from the median: estimates the standard deviation
// even if nearly half of the values are outliers. `values` must not be empty.
double RobustSigma(const std::vector<double>& values);

// The same about zero instead of the median, for the residuals of a fit with that many parameters,
// which made them smaller than the noise. Infinite for no more values than parameters.
double RobustSigmaAboutZero(std::vector<double> residuals, double num_parameters = 0.0);

// The root of the mean square; 0 for no values.
double Rms(const std::vector<double>& values);

// At most `max_count` items, evenly over the list.
template <typename Item>
std::vector<Item> Thinned(const std::vector<Item>& items, std::size_t max_count) {
  if (items.size() <= max_count) return items;
  std::vector<Item> thinned;
  for (std::size_t i = 0; i < max_count; ++i)
    thinned.push_back(items[i * items.size() / max_count]);
  return thinned;
}

}  // namespace velamap
