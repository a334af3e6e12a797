#include "reconstruct/adjust/marker_sizes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/statistics.h"
#include "reconstruct/adjust/marker_adjustment_options.h"
#include "reconstruct/geometry/covariance_update.h"

namespace velamap {
namespace {

constexpr double kMaxSigmas = 4.0;

// The mean side of a marker divided by the printed length, and its uncertainty.
struct MarkerSize {
  int marker_id = 0;
  int num_sides = 0;
  double ratio = 0.0;
  double block_variance = 0.0;  // part of the ratio's variance that other markers do not share
  Eigen::VectorXd by_factor;    // shared part: factor of the covariance times the ratio's gradient
};

std::vector<MarkerSize> MeasureMarkers(const MarkerState& state,
                                       const MarkerCovariance& covariance) {
  std::vector<MarkerSize> sizes;
  for (std::size_t i = 0; i < state.markers.size(); ++i) {
    const MarkerBlock& marker = state.markers[i];
    const auto sides = MarkerPriorError::Sides(marker.corners);
    if (sides.empty()) continue;
    MarkerSize size;
    size.marker_id = marker.marker_id;
    size.num_sides = static_cast<int>(sides.size());
    const double weight = 1.0 / (size.num_sides * marker.length_m);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(marker.NumCoordinates());
    for (const auto& [a, b] : sides) {
      const Eigen::Vector3d side = CornerPosition(marker, b) - CornerPosition(marker, a);
      size.ratio += weight * side.norm();
      gradient.segment<3>(3 * a) -= weight * side.normalized();
      gradient.segment<3>(3 * b) += weight * side.normalized();
    }
    size.block_variance = gradient.dot(covariance.marker_blocks[i] * gradient);
    size.by_factor = covariance.FactorOf(i).transpose() * gradient;
    sizes.push_back(std::move(size));
  }
  return sizes;
}

// Deviations of the ratios from their median, and the variance of each that image noise causes.
// Errors that all markers share (the scale) cancel.
struct Deviations {
  double median = 1.0;
  std::vector<double> values;
  std::vector<double> variances;
};

Deviations FindDeviations(const std::vector<MarkerSize>& sizes) {
  std::vector<double> ratios;
  Eigen::VectorXd mean_by_factor = Eigen::VectorXd::Zero(sizes.front().by_factor.size());
  const double count = static_cast<double>(sizes.size());
  for (const MarkerSize& size : sizes) {
    ratios.push_back(size.ratio);
    mean_by_factor += size.by_factor / count;
  }
  Deviations deviations;
  deviations.median = Median(ratios);
  for (const MarkerSize& size : sizes) {
    deviations.values.push_back(size.ratio / deviations.median - 1.0);
    deviations.variances.push_back(size.block_variance +
                                   (size.by_factor - mean_by_factor).squaredNorm());
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

std::string PointName(int marker_id, int corner) {
  return corner == 0 ? fmt::format("the centre of marker {}", marker_id)
                     : fmt::format("corner {} of marker {}", corner, marker_id);
}

// Vector from the first point of the bar to the second.
Eigen::Vector3d BarVector(const ScaleBar& bar, const MarkerState& state) {
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  for (std::size_t block = 0; block < bar.marker_idxs.size(); ++block) {
    const MarkerBlock& marker = state.markers[bar.marker_idxs[block]];
    for (std::size_t slot = 0; slot < marker.corners.size(); ++slot) {
      vector += bar.corner_weights[block][slot] * CornerPosition(marker, static_cast<int>(slot));
    }
  }
  return vector;
}

// Adds one end of a bar. Returns false where corners of it are missing.
bool AddEnd(const MarkerState& state, int marker_id, int corner, double sign, ScaleBar* bar) {
  const auto marker =
      std::find_if(state.markers.begin(), state.markers.end(),
                   [marker_id](const MarkerBlock& other) { return other.marker_id == marker_id; });
  if (marker == state.markers.end()) return false;
  if (corner == 0 && marker->corners.size() != kNumCorners) return false;
  std::vector<double> weights(marker->corners.size(), 0.0);
  if (corner == 0) {
    std::fill(weights.begin(), weights.end(), sign / kNumCorners);
  } else {
    const auto it = std::find(marker->corners.begin(), marker->corners.end(), corner);
    if (it == marker->corners.end()) return false;
    weights[it - marker->corners.begin()] = sign;
  }
  const int marker_idx = static_cast<int>(marker - state.markers.begin());
  if (!bar->marker_idxs.empty() && bar->marker_idxs.front() == marker_idx) {
    for (std::size_t i = 0; i < weights.size(); ++i) bar->corner_weights.front()[i] += weights[i];
    return true;
  }
  bar->marker_idxs.push_back(marker_idx);
  bar->corner_weights.push_back(std::move(weights));
  return true;
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
    throw DataError(
        "no marker of the model has two neighbouring corners, so that its size is "
        "unknown");
  }
  return Median(std::move(scales));
}

MarkerSizeVerdict JudgeMarkerSizes(const MarkerState& state, const MarkerCovariance& covariance,
                                   double print_tolerance) {
  const std::vector<MarkerSize> sizes = MeasureMarkers(state, covariance);
  MarkerSizeVerdict verdict;
  verdict.print_tolerance = print_tolerance;
  if (sizes.size() < 3) return verdict;  // of two, neither can be told to be the wrong one
  const Deviations deviations = FindDeviations(sizes);
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
        "marker {} is {:.2f} % {} than the layout says, compared with the other markers ({:.0f} "
        "sigmas): its size is not used; check its marker_length and its print",
        sizes[i].marker_id, 100 * std::abs(deviations.values[i]),
        deviations.values[i] > 0 ? "larger" : "smaller", std::abs(normalized[i])));
  }
  return verdict;
}

std::vector<ScaleBar> FindScaleBars(const MarkerState& state, const Layout& layout) {
  std::vector<ScaleBar> bars;
  for (const KnownDistance& distance : layout.distances) {
    if (!distance.is_scale_bar) continue;
    ScaleBar bar;
    bar.distance = distance;
    if (AddEnd(state, distance.marker_id1, distance.corner1, -1.0, &bar) &&
        AddEnd(state, distance.marker_id2, distance.corner2, 1.0, &bar)) {
      bars.push_back(std::move(bar));
    }
  }
  return bars;
}

Eigen::VectorXd BarGradient(const ScaleBar& bar, const MarkerState& state) {
  const Eigen::Vector3d direction = BarVector(bar, state).normalized();
  std::vector<Eigen::Index> begins = {0};
  for (const MarkerBlock& marker : state.markers) {
    begins.push_back(begins.back() + marker.NumCoordinates());
  }
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(begins.back());
  for (std::size_t block = 0; block < bar.marker_idxs.size(); ++block) {
    const std::vector<double>& weights = bar.corner_weights[block];
    for (std::size_t slot = 0; slot < weights.size(); ++slot) {
      gradient.segment<3>(begins[bar.marker_idxs[block]] + 3 * static_cast<Eigen::Index>(slot)) =
          weights[slot] * direction;
    }
  }
  return gradient;
}

std::string FindContradiction(const ScaleBar& bar, const MarkerState& state,
                              const PointCovariance& points) {
  const KnownDistance& distance = bar.distance;
  const double length_m = BarVector(bar, state).norm();
  const Eigen::VectorXd gradient = BarGradient(bar, state);
  const double variance = std::max(0.0, gradient.dot(Multiply(points, gradient).col(0)));
  const double sigmas = std::abs(length_m - distance.length_m) /
                        std::sqrt(variance + distance.sigma_m * distance.sigma_m);
  if (sigmas <= kMaxSigmas) return "";
  return fmt::format(
      "the distance from {} to {} is {:.5g} m in the layout, but {:.5g} +- {:.2g} m measured by "
      "the "
      "markers ({:.0f} sigmas): it is not used; check it and marker_length",
      PointName(distance.marker_id1, distance.corner1),
      PointName(distance.marker_id2, distance.corner2), distance.length_m, length_m,
      std::sqrt(variance), sigmas);
}

}  // namespace velamap
