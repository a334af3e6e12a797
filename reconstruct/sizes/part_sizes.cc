#include "reconstruct/sizes/part_sizes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <boost/math/distributions/students_t.hpp>

namespace velamap {
namespace {

// The mean size of a part, without the markers that contradict the others of the part.
struct PartSize {
  std::string part;
  std::size_t num_markers = 0;
  double ratio = 0.0;         // mean of MarkerSize::ratio
  double own_variance = 0.0;  // of the ratio, without the errors that other parts share
  Eigen::VectorXd by_factor;  // mean of MarkerSize::by_factor
};

// The part with the most markers comes first.
std::vector<PartSize> MeasureParts(const std::vector<MarkerSize>& sizes, double print_tolerance) {
  const Deviations deviations = FindDeviationsInParts(sizes, 0.0);
  const double tolerance = FitTolerance(deviations, sizes, print_tolerance);
  const std::vector<double> normalized = Normalize(deviations, sizes, tolerance);
  std::vector<PartSize> parts;
  for (const auto& [part, all] : GroupByPart(sizes)) {
    if (all.size() < kMinMarkersOfPart) continue;
    MarkerIdxs idxs;
    std::copy_if(all.begin(), all.end(), std::back_inserter(idxs),
                 [&](std::size_t i) { return std::abs(normalized[i]) <= kMaxSizeSigmas; });
    if (idxs.empty()) continue;  // no marker is near the median of two equally large groups
    PartSize size{part, idxs.size(), 0.0, 0.0, MeanByFactor(sizes, idxs)};
    const double count = static_cast<double>(idxs.size());
    for (const std::size_t i : idxs) {
      size.ratio += sizes[i].ratio / count;
      const double variance = sizes[i].block_variance + tolerance * tolerance / sizes[i].num_sides;
      size.own_variance += variance / (count * count);
    }
    parts.push_back(std::move(size));
  }
  std::stable_sort(parts.begin(), parts.end(), [](const PartSize& a, const PartSize& b) {
    return a.num_markers > b.num_markers;
  });
  return parts;
}

// The difference of a part from the mean of the others, as a fraction.
struct PartDifference {
  double value = 0.0;
  double sigma = 0.0;
  double Sigmas() const { return std::abs(value) / sigma; }
};

PartDifference CompareWithOthers(const std::vector<PartSize>& parts, std::size_t idx) {
  const double num_others = static_cast<double>(parts.size()) - 1.0;
  double ratio = 0.0, variance = parts[idx].own_variance;
  Eigen::VectorXd by_factor = parts[idx].by_factor;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i == idx) continue;
    ratio += parts[i].ratio / num_others;
    variance += parts[i].own_variance / (num_others * num_others);
    by_factor -= parts[i].by_factor / num_others;
  }
  return {parts[idx].ratio / ratio - 1.0, std::sqrt(variance + by_factor.squaredNorm())};
}

// The scatter of few parts is uncertain itself: half the width of the interval that holds 68 % of
// Student's t, 1.84 for two parts.
double FactorOfFew(std::size_t num_parts) {
  constexpr double kBelowOneSigma = 0.841344746;
  const boost::math::students_t distribution(static_cast<double>(num_parts) - 1.0);
  return boost::math::quantile(distribution, kBelowOneSigma);
}

std::string DisagreementText(const std::vector<PartSize>& parts, std::size_t idx,
                             const PartDifference& difference) {
  const std::string others = parts.size() == 2 ? parts[1 - idx].part : "the other parts";
  return fmt::format(
      "{} and {} disagree by {:.2f} +- {:.2f} % (relative to marker_length, the markers of {} are "
      "{})",
      parts[idx].part, others, 100 * std::abs(difference.value), 100 * difference.sigma,
      parts[idx].part, difference.value > 0 ? "larger" : "smaller");
}

}  // namespace

PartsVerdict JudgeParts(const std::vector<MarkerSize>& sizes, double print_tolerance,
                        double print_scale_sigma) {
  const std::vector<PartSize> parts = MeasureParts(sizes, print_tolerance);
  if (parts.size() < 2) return {};
  const double count = static_cast<double>(parts.size());
  std::vector<PartDifference> differences;
  double scatter = 0.0, noise = 0.0;  // variances of the parts' scales: measured, and expected
  for (std::size_t i = 0; i < parts.size(); ++i) {
    differences.push_back(CompareWithOthers(parts, i));
    // The mean of all parts includes this one, so the difference from it is smaller.
    const double from_mean = differences[i].value * (count - 1) / count;
    scatter += from_mean * from_mean / (count - 1);
    noise += std::pow(differences[i].sigma, 2) * (count - 1) / (count * count);
  }
  // Of two parts, each differs from the other by the same amount, so the one with more markers is
  // reported.
  const auto worst = std::max_element(
      differences.begin(), parts.size() > 2 ? differences.end() : differences.begin() + 1,
      [](const PartDifference& a, const PartDifference& b) { return a.Sigmas() < b.Sigmas(); });
  if (worst->Sigmas() <= kMaxSizeSigmas || std::abs(worst->value) <= print_scale_sigma) return {};
  const auto idx = static_cast<std::size_t>(worst - differences.begin());
  return {FactorOfFew(parts.size()) * std::sqrt(std::max(scatter - noise, 0.0)),
          DisagreementText(parts, idx, *worst)};
}

}  // namespace velamap
