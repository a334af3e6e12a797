#include "reconstruct/sizes/scale_bar_verdict.h"
#include "importer/geometry/units.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace velamap {
namespace {

// A distance that is this many sigmas off contradicts the others.
constexpr double kMaxBarSigmas = 4.0;
// Larger differences between distances and markers are explained by the scale of the print instead
// of chance.
constexpr double kMaxChanceSigmas = 3.0;
// How far a single distance and the markers can be apart before the distance is a mistake, as a
// logarithm. Cameras move edges by up to 3 % of a small marker; a page that was scaled to fit
// another paper shrinks by 3 to 6 %. The wrong neighbour, corner or unit is farther off.
constexpr double kMaxSingleLogScale = 0.07;
// The same for distances that agree with each other. It lies between 2 (half of a side taken for
// the side) and 2.54 (inches taken for centimetres, the smallest mistake of unit).
constexpr double kMaxCommonScale = 2.25;

std::string PointText(int marker_id, int corner) {
  return corner == 0 ? fmt::format("the centre of marker {}", marker_id)
                     : fmt::format("corner {} of marker {}", corner, marker_id);
}

// Logarithms of the measured lengths over the lengths in the model, and their covariance if the
// scale of the print is known.
struct LogScales {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
};

LogScales MeasureScales(const std::vector<ScaleBar>& bars, const MarkerState& state,
                        const Eigen::MatrixXd& covariance_m2) {
  const auto count = static_cast<Eigen::Index>(bars.size());
  Eigen::VectorXd inverse_lengths(count);
  LogScales scales{Eigen::VectorXd(count), {}};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double length_m = BarLength(bars[i], state);
    inverse_lengths[i] = 1.0 / length_m;
    scales.values[i] = std::log(bars[i].distance.length_m / length_m);
  }
  scales.covariance = inverse_lengths.asDiagonal() * covariance_m2 * inverse_lengths.asDiagonal();
  for (Eigen::Index i = 0; i < count; ++i) {
    const KnownDistance& distance = bars[i].distance;
    scales.covariance(i, i) += std::pow(distance.sigma_m / distance.length_m, 2);
  }
  return scales;
}

using BarSet = std::set<Eigen::Index>;

// Mean of a set, weighted by the variances, without the bar `left_out` (-1: with all).
struct CommonScale {
  double mean = 0.0;
  double variance = 0.0;
  Eigen::VectorXd weights;  // of all bars; 0 outside of the set
};

CommonScale MeanOf(const LogScales& scales, const BarSet& set, Eigen::Index left_out = -1) {
  CommonScale common{0.0, 0.0, Eigen::VectorXd::Zero(scales.values.size())};
  for (const Eigen::Index i : set) {
    if (i != left_out) common.weights[i] = 1.0 / scales.covariance(i, i);
  }
  common.weights /= common.weights.sum();
  common.mean = common.weights.dot(scales.values);
  common.variance = common.weights.dot(scales.covariance * common.weights);
  return common;
}

// Difference of one bar from the mean of a set that does not hold it, and its sigma.
struct Difference {
  double value = 0.0;
  double sigma = 0.0;
  bool Contradicts() const { return std::abs(value) > kMaxBarSigmas * sigma; }
};

Difference DifferenceFrom(const LogScales& scales, const CommonScale& others, Eigen::Index bar) {
  const double variance = scales.covariance(bar, bar) + others.variance -
                          2 * others.weights.dot(scales.covariance.col(bar));
  return {scales.values[bar] - others.mean, std::sqrt(std::max(0.0, variance))};
}

// The bars that agree with `seed`, then with each other.
BarSet FindAgreeing(const LogScales& scales, Eigen::Index seed) {
  constexpr int kMaxNumRounds = 10;
  BarSet set;
  for (Eigen::Index i = 0; i < scales.values.size(); ++i) {
    const double variance =
        scales.covariance(i, i) + scales.covariance(seed, seed) - 2 * scales.covariance(i, seed);
    const Difference difference{scales.values[i] - scales.values[seed],
                                std::sqrt(std::max(0.0, variance))};
    if (!difference.Contradicts()) set.insert(i);
  }
  for (int round = 0; round < kMaxNumRounds && set.size() > 1; ++round) {
    BarSet next;
    for (Eigen::Index i = 0; i < scales.values.size(); ++i) {
      if (!DifferenceFrom(scales, MeanOf(scales, set, i), i).Contradicts()) next.insert(i);
    }
    if (next == set || next.empty()) break;
    set = std::move(next);
  }
  return set;
}

struct Consensus {
  BarSet set;
  CommonScale common;
  bool is_alone = true;  // no other set is as large
};

// The largest set; of equally large ones, the one nearest to the markers.
Consensus FindConsensus(const LogScales& scales, double print_scale_sigma) {
  const auto sigmas_off = [&](const CommonScale& common) {
    return std::abs(common.mean) / std::sqrt(common.variance + std::pow(print_scale_sigma, 2));
  };
  std::set<BarSet> sets;
  for (Eigen::Index seed = 0; seed < scales.values.size(); ++seed) {
    sets.insert(FindAgreeing(scales, seed));
  }
  Consensus best;
  for (const BarSet& set : sets) {
    if (set.size() < best.set.size()) continue;
    const CommonScale common = MeanOf(scales, set);
    const bool is_larger = set.size() > best.set.size();
    const bool is_nearer = !is_larger && sigmas_off(common) < sigmas_off(best.common);
    if (is_larger || is_nearer) {
      best.set = set;
      best.common = common;
    }
    best.is_alone = is_larger;
  }
  return best;
}

std::string NameOf(const KnownDistance& distance) {
  return fmt::format("the distance from {} to {}", PointText(distance.marker_id1, distance.corner1),
                     PointText(distance.marker_id2, distance.corner2));
}

// Compares the bar with the length that the others give it. States the difference in mm and in
// sigmas.
std::string ComparedWith(const char* others, const ScaleBar& bar, const Difference& difference) {
  const double length_m = bar.distance.length_m;
  const double expected_m = length_m * std::exp(-difference.value);
  return fmt::format("{} is {:.5g} m in the layout, but {:.5g} m by {} ({:+.1f} mm, {:.0f} sigmas)",
                     NameOf(bar.distance), length_m, expected_m, others,
                     kMmPerM * (length_m - expected_m),
                     std::abs(difference.value) / difference.sigma);
}

// The reason why a set of bars does not overrule the markers; empty if it does.
std::string ReasonAgainst(const Consensus& consensus, Eigen::Index num_bars) {
  if (num_bars > 1 && !consensus.is_alone) {
    return "measured distances contradict each other, and none of them fits the markers";
  }
  const double log_scale = std::abs(consensus.common.mean);
  if (num_bars > 1 && consensus.set.size() > 1) {
    return log_scale > std::log(kMaxCommonScale) ? "check the unit of distances and marker_length"
                                                 : "";
  }
  return log_scale > kMaxSingleLogScale
             ? "more than a print or a camera explains: check its unit, ids and corners"
             : "";
}

std::string OverruledText(const CommonScale& common, std::size_t num_bars) {
  return fmt::format(
      "the measured distance{} the markers {:.2f} +- {:.2f} % {} than marker_length: the "
      "distance{} used; check the printed size (marker_length) or whether the camera's processing "
      "moves edges",
      num_bars > 1 ? "s make" : " makes", 100 * std::abs(std::expm1(common.mean)),
      100 * std::sqrt(common.variance), common.mean > 0 ? "larger" : "smaller",
      num_bars > 1 ? "s are" : " is");
}

}  // namespace

ScaleBarVerdict JudgeScaleBars(const std::vector<ScaleBar>& bars, const MarkerState& state,
                               const Eigen::MatrixXd& covariance_m2, double print_scale_sigma) {
  ScaleBarVerdict verdict;
  if (bars.empty()) return verdict;
  const LogScales scales = MeasureScales(bars, state, covariance_m2);
  const Consensus consensus = FindConsensus(scales, print_scale_sigma);
  const CommonScale& common = consensus.common;
  const auto num_bars = static_cast<Eigen::Index>(bars.size());
  // The markers by themselves: the scale 1 with the sigma of the print.
  const CommonScale markers{0.0, std::pow(print_scale_sigma, 2), Eigen::VectorXd::Zero(num_bars)};
  const double sigma = std::sqrt(common.variance + markers.variance);
  const Difference from_markers{common.mean, sigma};
  const std::string reason =
      from_markers.Contradicts() ? ReasonAgainst(consensus, num_bars) : std::string();
  if (!reason.empty()) {
    for (Eigen::Index i = 0; i < num_bars; ++i) {
      verdict.warnings.push_back(
          ComparedWith("the markers", bars[i], DifferenceFrom(scales, markers, i)) +
          ": it is not used; " + reason);
    }
    return verdict;
  }
  const bool has_majority = consensus.is_alone && consensus.set.size() > 1;
  for (Eigen::Index i = 0; i < num_bars; ++i) {
    if (consensus.set.count(i) > 0) {
      verdict.used.push_back(bars[i].distance);
      continue;
    }
    verdict.warnings.push_back(
        ComparedWith(has_majority ? "the other measured distances" : "the markers and the others",
                     bars[i], DifferenceFrom(scales, common, i)) +
        ": it is not used; check its length, ids and corners");
  }
  if (std::abs(common.mean) <= kMaxChanceSigmas * sigma) return verdict;
  verdict.scale = std::exp(common.mean);
  // With this variance, a deviation of one sigma explains the contradiction.
  verdict.print_scale_sigma =
      std::sqrt(std::max(std::pow(verdict.scale - 1.0, 2) - common.variance, markers.variance));
  verdict.warnings.push_back(OverruledText(common, consensus.set.size()));
  return verdict;
}

std::vector<std::string> LostScaleBars(const std::vector<KnownDistance>& used,
                                       const MarkerState& state) {
  std::vector<std::string> warnings;
  for (const KnownDistance& distance : used) {
    if (!FindScaleBars(state, {distance}).empty()) continue;
    warnings.push_back(NameOf(distance) +
                       " is not used after all: too few images agree on a corner that it needs; "
                       "measure between corners that more images show");
  }
  return warnings;
}

}  // namespace velamap
