#include "reconstruct/sizes/part_sizes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "reconstruct/sizes/student_factor.h"

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

std::vector<MarkerSize> OfLargeParts(const std::vector<MarkerSize>& sizes) {
  std::vector<MarkerSize> of_large_parts;
  for (const auto& [part, idxs] : GroupByPart(sizes)) {
    if (idxs.size() < kMinMarkersOfPart) continue;
    for (const std::size_t i : idxs) of_large_parts.push_back(sizes[i]);
  }
  return of_large_parts;
}

// The part with the most markers comes first.
std::vector<PartSize> MeasureParts(const std::vector<MarkerSize>& sizes, double print_tolerance) {
  const SizeAgreement agreement =
      JudgeDeviations(FindDeviationsInParts(sizes, 0.0), sizes, print_tolerance);
  std::vector<PartSize> parts;
  for (const auto& [part, all] : GroupByPart(sizes)) {
    MarkerIdxs idxs;
    std::copy_if(all.begin(), all.end(), std::back_inserter(idxs),
                 [&](std::size_t i) { return !agreement.is_contradicting[i]; });
    if (idxs.empty()) continue;  // no marker is near the median of two equally large groups
    PartSize size{part, idxs.size(), 0.0, 0.0, MeanByFactor(sizes, idxs)};
    const double count = static_cast<double>(idxs.size());
    for (const std::size_t i : idxs) {
      size.ratio += sizes[i].ratio / count;
      const double variance =
          sizes[i].block_variance + std::pow(agreement.print_tolerance, 2) / sizes[i].num_sides;
      size.own_variance += variance / (count * count);
    }
    // Slant and background differ more between parts than within one, and so does the inset of the
    // corners, whose sigma is the last of these errors.
    size.own_variance += std::pow(size.by_factor[size.by_factor.size() - 1], 2);
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

// The others count by their own precision: a part that is hardly known decides nothing.
PartDifference CompareWithOthers(const std::vector<PartSize>& parts, std::size_t idx) {
  double sum_of_weights = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i != idx) sum_of_weights += 1.0 / parts[i].own_variance;
  }
  double ratio = 0.0;
  Eigen::VectorXd by_factor = parts[idx].by_factor;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i == idx) continue;
    const double share = 1.0 / (parts[i].own_variance * sum_of_weights);
    ratio += share * parts[i].ratio;
    by_factor -= share * parts[i].by_factor;
  }
  const double own_variance = parts[idx].own_variance + 1.0 / sum_of_weights;
  return {parts[idx].ratio / ratio - 1.0, std::sqrt(own_variance + by_factor.squaredNorm())};
}

// 1 sigma of the scale, as a fraction, from how much farther than their uncertainty the parts are
// from each other (DerSimonian and Laird, "Meta-analysis in clinical trials", 1986). Few parts are
// uncertain evidence; parts that are hardly known count as less than one each.
double ScaleSigma(const std::vector<PartSize>& parts) {
  const auto count = static_cast<Eigen::Index>(parts.size());
  Eigen::ArrayXd ratios(count), variances(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    ratios[i] = parts[static_cast<std::size_t>(i)].ratio;
    variances[i] = parts[static_cast<std::size_t>(i)].own_variance;
  }
  const Eigen::ArrayXd shares = variances.inverse() / variances.inverse().sum();
  Eigen::VectorXd mean_by_factor = Eigen::VectorXd::Zero(parts.front().by_factor.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    mean_by_factor += shares[i] * parts[static_cast<std::size_t>(i)].by_factor;
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    variances[i] += (parts[static_cast<std::size_t>(i)].by_factor - mean_by_factor).squaredNorm();
  }
  const Eigen::ArrayXd weights = variances.inverse();
  const double mean = (weights * ratios).sum() / weights.sum();
  const double scatter = (weights * (ratios / mean - 1.0).square()).sum();
  const double between =
      std::max(0.0, (scatter - static_cast<double>(count - 1)) /
                        (weights.sum() - weights.square().sum() / weights.sum()));
  const Eigen::ArrayXd total = (variances + between).inverse();
  const double effective_count = total.sum() * total.sum() / total.square().sum();
  return StudentFactor(std::max(1.0, effective_count - 1.0)) * std::sqrt(between);
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
  const std::vector<MarkerSize> of_large_parts = OfLargeParts(sizes);
  if (GroupByPart(of_large_parts).size() < 2) return {};
  const std::vector<PartSize> parts = MeasureParts(of_large_parts, print_tolerance);
  if (parts.size() < 2) return {};
  std::vector<PartDifference> differences;
  for (std::size_t i = 0; i < parts.size(); ++i) differences.push_back(CompareWithOthers(parts, i));
  // Of two parts, each differs from the other by the same amount, so the one with more markers is
  // reported.
  const auto worst = std::max_element(
      differences.begin(), parts.size() > 2 ? differences.end() : differences.begin() + 1,
      [](const PartDifference& a, const PartDifference& b) { return a.Sigmas() < b.Sigmas(); });
  if (worst->Sigmas() <= kMaxSizeSigmas || std::abs(worst->value) <= print_scale_sigma) return {};
  const auto idx = static_cast<std::size_t>(worst - differences.begin());
  return {ScaleSigma(parts), DisagreementText(parts, idx, *worst)};
}

}  // namespace velamap
