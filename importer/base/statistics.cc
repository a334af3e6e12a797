#include "importer/base/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "importer/base/error.h"

namespace velamap {

double Statistics::MaxAbs() const { return std::max(std::abs(min), std::abs(max)); }

Statistics ComputeStatistics(std::vector<double> values) {
  Statistics statistics;
  if (values.empty()) return statistics;
  // Sorting makes the sums independent of the order of the input.
  std::sort(values.begin(), values.end());
  const double count = static_cast<double>(values.size());
  statistics.count = static_cast<int>(values.size());
  statistics.mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double squared_deviations = 0.0;
  for (const double value : values) {
    squared_deviations += (value - statistics.mean) * (value - statistics.mean);
  }
  statistics.rms = Rms(values);
  if (values.size() > 1) {
    statistics.standard_deviation = std::sqrt(squared_deviations / (count - 1));
  }
  statistics.min = values.front();
  statistics.max = values.back();
  statistics.median = Median(std::move(values));
  return statistics;
}

double Median(std::vector<double> values) {
  VELAMAP_CHECK(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double RobustSigma(const std::vector<double>& values) {
  const double median = Median(values);
  std::vector<double> deviations;
  deviations.reserve(values.size());
  for (const double value : values) deviations.push_back(std::abs(value - median));
  return kMadToSigma * Median(std::move(deviations));
}

double RobustSigmaAboutZero(std::vector<double> residuals, double num_parameters) {
  const double num = static_cast<double>(residuals.size());
  if (!(num > num_parameters)) return std::numeric_limits<double>::infinity();
  for (double& residual : residuals) residual = std::abs(residual);
  return kMadToSigma * Median(std::move(residuals)) * std::sqrt(num / (num - num_parameters));
}

double Rms(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const double squares = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace velamap
