// How far the mean sides of markers deviate from the others, and how much of this image noise
// explains.

#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "reconstruct/problem/marker_state.h"
#include "reconstruct/problem/normal_equations.h"

namespace velamap {

// A marker or a part that deviates by more sigmas contradicts the others.
inline constexpr double kMaxSizeSigmas = 4.0;
// With fewer markers, one bad print could decide the size of the whole part.
inline constexpr std::size_t kMinMarkersOfPart = 3;

// The mean side of a marker divided by the printed length, and its uncertainty.
struct MarkerSize {
  int marker_id = 0;
  std::string part;
  int num_sides = 0;
  double ratio = 0.0;
  double unevenness = 0.0;      // longest minus shortest side, divided by the printed length
  double block_variance = 0.0;  // of the ratio, without the errors that other markers share
  // The shared errors of the ratio: the factor of the covariance times the gradient of the ratio,
  // then the sigma of the inset. The dot product of two markers' vectors is their covariance.
  Eigen::VectorXd by_factor;
};

using MarkerIdxs = std::vector<std::size_t>;  // indices into a vector of sizes

// Markers without a whole side are left out. `inset_sigmas` holds, by marker id, the sigma of a
// marker's size that is due to the inset of its corners, as a fraction. It enters twice, as an
// error that all markers share and as an equally large independent error of each marker, because
// blur and the background around the margin vary between markers.
std::vector<MarkerSize> MeasureMarkers(const MarkerState& state, const MarkerCovariance& covariance,
                                       const std::map<int, double>& inset_sigmas);

std::map<std::string, MarkerIdxs> GroupByPart(const std::vector<MarkerSize>& sizes);

Eigen::VectorXd MeanByFactor(const std::vector<MarkerSize>& sizes, const MarkerIdxs& idxs);

// By marker, the deviation of the ratio from the median of a group of markers, as a fraction, and
// its variance due to image noise. Errors that the whole group shares, such as the scale, cancel.
struct Deviations {
  explicit Deviations(std::size_t size) : values(size), variances(size) {}
  std::vector<double> values, variances;
};

// Deviations from the median of all markers.
Deviations FindDeviations(const std::vector<MarkerSize>& sizes);

// Deviations from the median of the marker's own part. The median of a part with fewer than
// kMinMarkersOfPart markers is unreliable, so its markers are compared with the median of all
// markers; `part_scale_sigma`, 1 sigma of the scale between parts, is then added to their sigma.
Deviations FindDeviationsInParts(const std::vector<MarkerSize>& sizes, double part_scale_sigma);

// The deviations in sigmas of image noise and print together. `tolerance` is 1 sigma of a printed
// side, as a fraction.
std::vector<double> Normalize(const Deviations& deviations, const std::vector<MarkerSize>& sizes,
                              double tolerance);

// The print tolerance that explains the scatter of the deviations. Returns `print_tolerance` for
// fewer than ten markers, and if they scatter at most 1.3 times as far as it explains.
double FitTolerance(const Deviations& deviations, const std::vector<MarkerSize>& sizes,
                    double print_tolerance);

}  // namespace velamap
