#include "reconstruct/sizes/size_deviations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "importer/base/statistics.h"
#include "reconstruct/problem/prior_cost_functions.h"

namespace velamap {
namespace {

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

}  // namespace

Eigen::VectorXd MeanByFactor(const std::vector<MarkerSize>& sizes, const MarkerIdxs& idxs) {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(sizes.front().by_factor.size());
  for (const std::size_t i : idxs) mean += sizes[i].by_factor / static_cast<double>(idxs.size());
  return mean;
}

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

}  // namespace velamap
