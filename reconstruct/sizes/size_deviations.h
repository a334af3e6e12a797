// How far the mean sides of markers deviate from those of the others, and how much of this is due
// to image noise.

#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "reconstruct/problem/marker_state.h"
#include "reconstruct/problem/normal_equations.h"

namespace velamap {

// A marker or a part that deviates by more sigmas contradicts the others.
inline constexpr double kMaxSizeSigmas = 4.0;
// With fewer markers, one bad print could decide the size of the whole part.
inline constexpr std::size_t kMinMarkersOfPart = 3;

// The mean side of a marker divided by its printed length, or on a curved surface by the chord, and
// its uncertainty.
struct MarkerSize {
  int marker_id = 0;
  std::string part;
  int num_sides = 0;
  double ratio = 0.0;
  double unevenness = 0.0;  // longest minus shortest side, divided by the printed length
  // Variance of the ratio, without the errors that other markers share and the print tolerance.
  double block_variance = 0.0;
  // The shared errors of the ratio: the factor of the covariance times the gradient of the ratio,
  // then the sigma of the inset. The dot product of two markers' vectors is their covariance.
  Eigen::VectorXd by_factor;
};

using MarkerIdxs = std::vector<std::size_t>;  // indices into a vector of sizes

// The change of each marker's MarkerSize::ratio (rows, in the order of the state; 0 without a whole
// side) by the coordinates of all points (columns).
Eigen::SparseMatrix<double> SizesByPoints(const MarkerState& state,
                                          const MarkerCovariance& covariance);

// Markers without a whole side are left out. The covariance's sigmas grow by `correlation_factor`.
// `inset_sigmas` holds, by marker id, the sigma of a marker's size that is due to the inset of its
// corners, as a fraction. It enters twice, as an error that all markers share and as an equally
// large independent error of each marker, because blur and the background around the margin vary
// between markers. `print_resolution_m` is 1 sigma of each printed side whatever its length; the
// variances contain it.
std::vector<MarkerSize> MeasureMarkers(const MarkerState& state, const MarkerCovariance& covariance,
                                       double correlation_factor,
                                       const std::map<int, double>& inset_sigmas,
                                       double print_resolution_m);

std::map<std::string, MarkerIdxs> GroupByPart(const std::vector<MarkerSize>& sizes);

Eigen::VectorXd MeanByFactor(const std::vector<MarkerSize>& sizes, const MarkerIdxs& idxs);

// By marker, the deviation of the ratio from the median of a group of markers, as a fraction, and
// its variance due to image noise and the printer's dots. Errors that the whole group shares, such
// as the scale, cancel.
struct Deviations {
  explicit Deviations(std::size_t size) : values(size), variances(size), shared(size) {}
  std::vector<double> values, variances;
  // The part of the variances that markers share: as MarkerSize::by_factor, less the median's.
  std::vector<Eigen::VectorXd> shared;
  std::size_t num_groups = 0;  // medians that come from the markers themselves
};

// Deviations from the median of all markers.
Deviations FindDeviations(const std::vector<MarkerSize>& sizes);

// Deviations from the median of the marker's own part. The median of a part with fewer than
// kMinMarkersOfPart markers is unreliable, so its markers are compared with the median of all
// markers; `part_scale_sigma`, 1 sigma of the scale between parts, is then added to their sigma.
Deviations FindDeviationsInParts(const std::vector<MarkerSize>& sizes, double part_scale_sigma);

// What the deviations say about the print.
struct SizeAgreement {
  // 1 sigma of a printed side, as a fraction, that explains the scatter of the markers that agree:
  // the given one or a larger one.
  double print_tolerance = 0.0;
  // By marker: the deviation in sigmas of image noise and print together, and whether it is beyond
  // kMaxSizeSigmas although most markers agree.
  std::vector<double> sigmas;
  std::vector<bool> is_contradicting;
  // Whether the markers scatter clearly more than the given tolerance explains.
  bool scatters_more = false;
};

// Markers contradict the others if they deviate by more than kMaxSizeSigmas while at least two
// thirds of the markers agree. Otherwise nothing shows which sizes are wrong, and all are used.
// `print_tolerance` is 1 sigma of a printed side, as a fraction. With ten or more markers per group
// it is raised if they scatter more than 1.3 times as far as it explains; they scatter clearly more
// if this is also beyond chance, because the median of ten deviations exceeds 1.3 times its
// expectation in a fifth of the cases. Fewer markers may agree by chance, so it is always raised to
// their scatter, which is widened by Student's t; they scatter clearly more if more than a third of
// them would contradict the others at the given tolerance.
// Errors that markers share, such as those of a camera that is hardly known, count once, however
// many markers show them. `sizes` must not be empty.
SizeAgreement JudgeDeviations(const Deviations& deviations, const std::vector<MarkerSize>& sizes,
                              double print_tolerance);

}  // namespace velamap
