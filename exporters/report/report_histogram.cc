#include "exporters/report/report_histogram.h"

#include <algorithm>
#include <cmath>

#include "exporters/scale/round_number.h"
#include "importer/base/statistics.h"

namespace velamap {
namespace {

constexpr double kMaxNumBins = 30;  // plus one at either end, where the range is rounded outwards
constexpr double kMaxSigmas = 6;

}  // namespace

Histogram MakeHistogram(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(),
                              [](double value) { return !std::isfinite(value); }),
               values.end());
  Histogram histogram;
  if (values.empty()) return histogram;
  const double median = Median(values);
  const double sigma = RobustSigma(values);
  double low = median, high = median;
  for (const double value : values) {
    // Without scatter, more than half of the values are equal and outliers are not defined.
    if (sigma > 0 && std::abs(value - median) > kMaxSigmas * sigma) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  // Equal values get one bin, wide enough for double precision.
  const double least_width = std::max(1e-12, 1e-9 * std::abs(median));
  histogram.bin_width = RoundUp(std::max((high - low) / kMaxNumBins, least_width));
  const double first = std::floor(low / histogram.bin_width);
  const double last = std::floor(high / histogram.bin_width);
  histogram.first_border = first * histogram.bin_width;
  histogram.counts.assign(static_cast<std::size_t>(last - first) + 1, 0);
  for (const double value : values) {
    const double bin = std::floor(value / histogram.bin_width);
    if (bin < first) {
      ++histogram.num_below;
    } else if (bin > last) {
      ++histogram.num_above;
    } else {
      ++histogram.counts[static_cast<std::size_t>(bin - first)];
    }
  }
  return histogram;
}

}  // namespace velamap
