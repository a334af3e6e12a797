#include "reconstruct/sizes/marker_sizes.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/statistics.h"
#include "reconstruct/problem/prior_cost_functions.h"
#include "reconstruct/sizes/part_sizes.h"

namespace velamap {
namespace {

// A marker that is printed at a wrong size has four equal sides. A corner that is covered or badly
// fitted changes only two sides.
std::string WhatToCheck(const MarkerSize& size, double deviation) {
  if (size.unevenness < std::abs(deviation)) return "check its marker_length and its print";
  return fmt::format("its sides differ by {:.2f} %, so look for what covers or bends it",
                     100 * size.unevenness);
}

}  // namespace

double MetresPerUnit(const MarkerState& state) {
  std::vector<double> scales;
  for (const MarkerBlock& marker : state.markers) {
    for (const auto& [a, b] : MarkerPriorError::Sides(marker.corners)) {
      const double side = (CornerPosition(marker, b) - CornerPosition(marker, a)).norm();
      if (side > 0) scales.push_back(marker.length_m / side);
    }
  }
  if (scales.empty()) {
    throw DataError(
        "no marker of the model has two neighbouring corners, so the scale is unknown; take more "
        "pictures of whole markers");
  }
  return Median(std::move(scales));
}

MarkerSizeVerdict JudgeMarkerSizes(const MarkerState& state, const MarkerCovariance& covariance,
                                   double correlation_factor,
                                   const std::map<int, double>& inset_sigmas,
                                   const MarkerAdjustmentOptions& options,
                                   double print_scale_sigma) {
  const double print_tolerance = options.print_tolerance;
  const std::vector<MarkerSize> sizes = MeasureMarkers(state, covariance, correlation_factor,
                                                       inset_sigmas, options.print_resolution_m);
  MarkerSizeVerdict verdict;
  verdict.print_tolerance = print_tolerance;
  if (sizes.size() < 3) return verdict;  // of two markers, either may be the wrong one
  PartsVerdict parts = JudgeParts(sizes, print_tolerance, print_scale_sigma);
  verdict.part_scale_sigma = parts.scale_sigma;
  verdict.part_disagreement = std::move(parts.disagreement);
  const Deviations deviations = verdict.part_scale_sigma > 0
                                    ? FindDeviationsInParts(sizes, verdict.part_scale_sigma)
                                    : FindDeviations(sizes);
  const SizeAgreement agreement = JudgeDeviations(deviations, sizes, print_tolerance);
  verdict.print_tolerance = agreement.print_tolerance;
  if (agreement.scatters_more) {
    verdict.warnings.push_back(fmt::format(
        "the sides of the markers scatter by {0:.2f} % beyond what the images and the dots of a "
        "printer explain, more than the print tolerance of {1:.2f} %; {0:.2f} % is used",
        100 * verdict.print_tolerance, 100 * print_tolerance));
  }
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (!agreement.is_contradicting[i]) continue;
    verdict.contradicting.insert(sizes[i].marker_id);
    verdict.warnings.push_back(fmt::format(
        "marker {} is {:.2f} % {} than the layout says, compared with the other markers{} "
        "({:.0f} sigmas): its size is not used; {}",
        sizes[i].marker_id, 100 * std::abs(deviations.values[i]),
        deviations.values[i] > 0 ? "larger" : "smaller",
        verdict.part_scale_sigma > 0 ? " of its part" : "", std::abs(agreement.sigmas[i]),
        WhatToCheck(sizes[i], deviations.values[i])));
  }
  return verdict;
}

}  // namespace velamap
