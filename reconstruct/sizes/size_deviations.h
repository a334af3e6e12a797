// How far the mean sides of markers deviate from the others, and what image noise explains of that.

#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "reconstruct/problem/marker_problem.h"
#include "reconstruct/problem/normal_equations.h"

namespace velamap {

// A marker, or a part, contradicts the others beyond this.
inline constexpr double kMaxSizeSigmas = 4.0;
// With fewer markers, one bad print could determine the size of the whole part.
inline constexpr std::size_t kMinMarkersOfPart = 3;

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

using MarkerIdxs = std::vector<std::size_t>;  // into the sizes

// Markers without a whole side are left out. `inset_sigmas`: 1 sigma of a marker's size, as a
// fraction, that the inset of its corners causes. It counts twice, as an error that all markers
// share and as an equally large one of each marker, because blur and the background behind the
// margin vary between markers.
std::vector<MarkerSize> MeasureMarkers(const MarkerState& state, const MarkerCovariance& covariance,
                                       const std::map<int, double>& inset_sigmas);

std::map<std::string, MarkerIdxs> GroupByPart(const std::vector<MarkerSize>& sizes);

Eigen::VectorXd MeanByFactor(const std::vector<MarkerSize>& sizes, const MarkerIdxs& idxs);

// Deviations of the ratios from the median of other markers, as fractions, and the variances that
// image noise gives them, by marker. Errors that all these markers share (the scale) cancel.
struct Deviations {
  explicit Deviations(std::size_t size) : values(size), variances(size) {}
  std::vector<double> values, variances;
};

// From the median of all markers.
Deviations FindDeviations(const std::vector<MarkerSize>& sizes);

// From the markers' own parts. The median of a part with fewer markers than kMinMarkersOfPart means
// little, so these are compared with all others, between whose parts the scale differs by
// `part_scale_sigma`.
Deviations FindDeviationsInParts(const std::vector<MarkerSize>& sizes, double part_scale_sigma);

// The deviations in sigmas of image noise and print together. `tolerance`: 1 sigma of a printed
// side, as a fraction.
std::vector<double> Normalize(const Deviations& deviations, const std::vector<MarkerSize>& sizes,
                              double tolerance);

// The tolerance that explains the scatter of the deviations, at least `print_tolerance`, which is
// returned for fewer than ten markers and where they scatter less than 1.3 times as far as it
// explains.
double FitTolerance(const Deviations& deviations, const std::vector<MarkerSize>& sizes,
                    double print_tolerance);

}  // namespace velamap
