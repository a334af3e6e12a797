#include "reconstruct/adjust/marker_sizes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/statistics.h"
#include "reconstruct/problem/marker_adjustment_options.h"
#include "reconstruct/problem/prior_cost_functions.h"

namespace velamap {
namespace {

constexpr double kMaxSigmas = 4.0;
// With fewer markers, one bad print could determine the size of the whole part.
constexpr std::size_t kMinMarkersOfPart = 3;

// The mean side of a marker divided by the printed length, and its uncertainty.
struct MarkerSize {
  int marker_id = 0;
  std::string part;
  int num_sides = 0;
  double ratio = 0.0;
  double unevenness = 0.0;      // longest minus shortest side, divided by the printed length
  double block_variance = 0.0;  // part of the ratio's variance that other markers do not share
  // The part that markers share: the factor of the covariance times the ratio's gradient, with the
  // inset last.
  Eigen::VectorXd by_factor;
};

// The inset counts twice, as an error that all markers share and as an equally large one of each
// marker, because blur and the background behind the margin vary between markers.
std::vector<MarkerSize> MeasureMarkers(const MarkerState& state, const MarkerCovariance& covariance,
                                       const std::map<int, double>& inset_sigmas) {
  std::vector<MarkerSize> sizes;
  for (std::size_t i = 0; i < state.markers.size(); ++i) {
    const MarkerBlock& marker = state.markers[i];
    const auto sides = MarkerPriorError::Sides(marker.corners);
    if (sides.empty()) continue;
    MarkerSize size;
    size.marker_id = marker.marker_id;
    size.part = marker.part;
    size.num_sides = static_cast<int>(sides.size());
    const double weight = 1.0 / (size.num_sides * marker.length_m);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(marker.NumCoordinates());
    double shortest_m = std::numeric_limits<double>::infinity(), longest_m = 0.0;
    for (const auto& [a, b] : sides) {
      const Eigen::Vector3d side = CornerPosition(marker, b) - CornerPosition(marker, a);
      shortest_m = std::min(shortest_m, side.norm());
      longest_m = std::max(longest_m, side.norm());
      size.ratio += weight * side.norm();
      gradient.segment<3>(3 * a) -= weight * side.normalized();
      gradient.segment<3>(3 * b) += weight * side.normalized();
    }
    size.unevenness = (longest_m - shortest_m) / marker.length_m;
    const auto found = inset_sigmas.find(marker.marker_id);
    const double inset_sigma = found == inset_sigmas.end() ? 0.0 : found->second;
    size.block_variance =
        gradient.dot(covariance.marker_blocks[i] * gradient) + inset_sigma * inset_sigma;
    size.by_factor.resize(covariance.factor.cols() + 1);
    size.by_factor << covariance.FactorOf(i).transpose() * gradient, inset_sigma;
    sizes.push_back(std::move(size));
  }
  return sizes;
}

// Deviations of the ratios from the median of other markers, and the variances that image noise
// gives them. Errors that all these markers share (the scale) cancel.
struct Deviations {
  explicit Deviations(std::size_t size) : values(size), variances(size) {}
  std::vector<double> values, variances;
};

using MarkerIdxs = std::vector<std::size_t>;  // into the sizes

Eigen::VectorXd MeanByFactor(const std::vector<MarkerSize>& sizes, const MarkerIdxs& idxs) {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(sizes.front().by_factor.size());
  for (const std::size_t i : idxs) mean += sizes[i].by_factor / static_cast<double>(idxs.size());
  return mean;
}

void Compare(const std::vector<MarkerSize>& sizes, const MarkerIdxs& idxs, const MarkerIdxs& others,
             double extra_variance, Deviations* deviations) {
  std::vector<double> ratios;
  for (const std::size_t i : others) ratios.push_back(sizes[i].ratio);
  const double median = Median(std::move(ratios));
  const Eigen::VectorXd mean_by_factor = MeanByFactor(sizes, others);
  for (const std::size_t i : idxs) {
    deviations->values[i] = sizes[i].ratio / median - 1.0;
    deviations->variances[i] = sizes[i].block_variance +
                               (sizes[i].by_factor - mean_by_factor).squaredNorm() + extra_variance;
  }
}

MarkerIdxs AllOf(const std::vector<MarkerSize>& sizes) {
  MarkerIdxs idxs(sizes.size());
  std::iota(idxs.begin(), idxs.end(), 0);
  return idxs;
}

Deviations FindDeviations(const std::vector<MarkerSize>& sizes) {
  Deviations deviations(sizes.size());
  Compare(sizes, AllOf(sizes), AllOf(sizes), 0.0, &deviations);
  return deviations;
}

std::map<std::string, MarkerIdxs> GroupByPart(const std::vector<MarkerSize>& sizes) {
  std::map<std::string, MarkerIdxs> parts;
  for (std::size_t i = 0; i < sizes.size(); ++i) parts[sizes[i].part].push_back(i);
  return parts;
}

// Deviations of the markers from their own parts. The median of a part with few markers means
// little, so these markers are compared with all others, between whose parts the scale differs by
// `part_scale_sigma`.
Deviations FindDeviationsInParts(const std::vector<MarkerSize>& sizes, double part_scale_sigma) {
  Deviations deviations(sizes.size());
  for (const auto& [part, idxs] : GroupByPart(sizes)) {
    if (idxs.size() >= kMinMarkersOfPart) {
      Compare(sizes, idxs, idxs, 0.0, &deviations);
    } else {
      Compare(sizes, idxs, AllOf(sizes), std::pow(part_scale_sigma, 2), &deviations);
    }
  }
  return deviations;
}

std::vector<double> Normalize(const Deviations& deviations, const std::vector<MarkerSize>& sizes,
                              double tolerance) {
  std::vector<double> normalized;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    normalized.push_back(
        deviations.values[i] /
        std::sqrt(deviations.variances[i] + tolerance * tolerance / sizes[i].num_sides));
  }
  return normalized;
}

// The tolerance that explains the scatter of the deviations, at least `print_tolerance`.
double FitTolerance(const Deviations& deviations, const std::vector<MarkerSize>& sizes,
                    double print_tolerance) {
  constexpr std::size_t kMinMarkers = 10;
  constexpr double kMaxScatter = 1.3;
  const auto scatter = [&](double tolerance) {
    return RobustSigma(Normalize(deviations, sizes, tolerance));
  };
  if (sizes.size() < kMinMarkers || !(scatter(print_tolerance) > kMaxScatter)) {
    return print_tolerance;
  }
  double low = print_tolerance, high = 1.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = std::sqrt(low * high);
    (scatter(middle) > 1.0 ? low : high) = middle;
  }
  return high;
}

// The mean ratio of a part's markers without those that contradict it.
struct PartSize {
  std::string part;
  std::size_t num_markers = 0;
  double ratio = 0.0;
  double own_variance = 0.0;  // part of the variance that other parts do not share
  Eigen::VectorXd by_factor;
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
                 [&](std::size_t i) { return std::abs(normalized[i]) <= kMaxSigmas; });
    if (idxs.empty()) continue;  // two groups of equal size: no marker is near the median
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

// A part against the mean of the others, as a fraction.
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

std::string DisagreementText(const std::vector<PartSize>& parts, std::size_t idx,
                             const PartDifference& difference) {
  const std::string others = parts.size() == 2 ? parts[1 - idx].part : "the other parts";
  return fmt::format(
      "{} and {} disagree by {:.2f} +- {:.2f} % (against marker_length the markers of {} are the "
      "{})",
      parts[idx].part, others, 100 * std::abs(difference.value), 100 * difference.sigma,
      parts[idx].part, difference.value > 0 ? "larger" : "smaller");
}

// Sets the verdict on parts if one differs from the others by more than chance, and by enough to
// matter compared with `print_scale_sigma`.
void JudgeParts(const std::vector<MarkerSize>& sizes, double print_tolerance,
                double print_scale_sigma, MarkerSizeVerdict* verdict) {
  const std::vector<PartSize> parts = MeasureParts(sizes, print_tolerance);
  if (parts.size() < 2) return;
  const double count = static_cast<double>(parts.size());
  std::vector<PartDifference> differences;
  double scatter = 0.0, noise = 0.0;  // of the parts' scales, squared
  for (std::size_t i = 0; i < parts.size(); ++i) {
    differences.push_back(CompareWithOthers(parts, i));
    // A part differs from the mean of all by less than from the mean of the others.
    const double from_mean = differences[i].value * (count - 1) / count;
    scatter += from_mean * from_mean / (count - 1);
    noise += std::pow(differences[i].sigma, 2) * (count - 1) / (count * count);
  }
  // Two parts differ from each other equally: the first stands for both.
  const auto worst = std::max_element(
      differences.begin(), parts.size() > 2 ? differences.end() : differences.begin() + 1,
      [](const PartDifference& a, const PartDifference& b) { return a.Sigmas() < b.Sigmas(); });
  if (worst->Sigmas() <= kMaxSigmas || std::abs(worst->value) <= print_scale_sigma) return;
  verdict->part_scale_sigma = std::sqrt(std::max(scatter - noise, 0.0));
  verdict->part_disagreement =
      DisagreementText(parts, static_cast<std::size_t>(worst - differences.begin()), *worst);
}

// A wrong print changes all sides alike; a covered or badly fitted corner changes two of them.
std::string WhatToCheck(const MarkerSize& size, double deviation) {
  if (size.unevenness < std::abs(deviation)) return "check its marker_length and its print";
  return fmt::format("its sides differ by {:.2f} %, so look for what covers or bends it",
                     100 * size.unevenness);
}

}  // namespace

double MedianScale(const MarkerState& state) {
  std::vector<double> scales;
  for (const MarkerBlock& marker : state.markers) {
    for (const auto& [a, b] : MarkerPriorError::Sides(marker.corners)) {
      const double side = (CornerPosition(marker, b) - CornerPosition(marker, a)).norm();
      if (side > 0) scales.push_back(marker.length_m / side);
    }
  }
  if (scales.empty()) {
    throw DataError("no marker of the model has two neighbouring corners, so the scale is unknown");
  }
  return Median(std::move(scales));
}

MarkerSizeVerdict JudgeMarkerSizes(const MarkerState& state, const MarkerCovariance& covariance,
                                   const std::map<int, double>& inset_sigmas,
                                   double print_tolerance, double print_scale_sigma) {
  const std::vector<MarkerSize> sizes = MeasureMarkers(state, covariance, inset_sigmas);
  MarkerSizeVerdict verdict;
  verdict.print_tolerance = print_tolerance;
  if (sizes.size() < 3) return verdict;  // with two markers, either may be the wrong one
  JudgeParts(sizes, print_tolerance, print_scale_sigma, &verdict);
  const Deviations deviations = verdict.part_scale_sigma > 0
                                    ? FindDeviationsInParts(sizes, verdict.part_scale_sigma)
                                    : FindDeviations(sizes);
  verdict.print_tolerance = FitTolerance(deviations, sizes, print_tolerance);
  if (verdict.print_tolerance > print_tolerance) {
    verdict.warnings.push_back(fmt::format(
        "the sides of the markers scatter by {:.2f} % more than the images explain, beyond the "
        "{:.2f} % of {}; the larger is used",
        100 * verdict.print_tolerance, 100 * print_tolerance,
        OptionName(&MarkerAdjustmentOptions::print_tolerance)));
  }
  const std::vector<double> normalized = Normalize(deviations, sizes, verdict.print_tolerance);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (std::abs(normalized[i]) <= kMaxSigmas) continue;
    verdict.contradicting.insert(sizes[i].marker_id);
    verdict.warnings.push_back(fmt::format(
        "marker {} is {:.2f} % {} than the layout says, compared with the other markers{} "
        "({:.0f} sigmas): its size is not used; {}",
        sizes[i].marker_id, 100 * std::abs(deviations.values[i]),
        deviations.values[i] > 0 ? "larger" : "smaller",
        verdict.part_scale_sigma > 0 ? " of its part" : "", std::abs(normalized[i]),
        WhatToCheck(sizes[i], deviations.values[i])));
  }
  return verdict;
}

}  // namespace velamap
