#include "reconstruct/sizes/size_deviations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Eigenvalues>
#include <boost/math/distributions/chi_squared.hpp>

#include "importer/base/statistics.h"
#include "reconstruct/problem/prior_cost_functions.h"
#include "reconstruct/sizes/student_factor.h"

namespace velamap {
namespace {

struct MedianSize {
  double ratio = 0.0;
  Eigen::VectorXd by_factor;
};

MedianSize MedianOf(const std::vector<MarkerSize>& sizes, MarkerIdxs idxs) {
  std::sort(idxs.begin(), idxs.end(),
            [&](std::size_t a, std::size_t b) { return sizes[a].ratio < sizes[b].ratio; });
  const MarkerSize& below = sizes[idxs[(idxs.size() - 1) / 2]];
  const MarkerSize& above = sizes[idxs[idxs.size() / 2]];
  return {0.5 * (below.ratio + above.ratio), 0.5 * (below.by_factor + above.by_factor)};
}

void Compare(const std::vector<MarkerSize>& sizes, const MarkerIdxs& idxs, const MarkerIdxs& others,
             double extra_variance, Deviations* deviations) {
  const MedianSize median = MedianOf(sizes, others);
  for (const std::size_t i : idxs) {
    // Derivatives of the quotient of the ratios, which the scale of all does not change.
    const double quotient = sizes[i].ratio / median.ratio;
    deviations->values[i] = quotient - 1.0;
    deviations->shared[i] = (sizes[i].by_factor - quotient * median.by_factor) / median.ratio;
    deviations->variances[i] =
        sizes[i].block_variance + deviations->shared[i].squaredNorm() + extra_variance;
  }
}

// The deviations in sigmas of image noise and print together.
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

// The smallest tolerance, at least `least`, at which `scatter` is at most 1.
template <typename Scatter>
double ExplainingTolerance(double least, const Scatter& scatter) {
  if (!(scatter(least) > 1.0)) return least;
  double low = least, high = 1.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = std::sqrt(low * high);
    (scatter(middle) > 1.0 ? low : high) = middle;
  }
  return high;
}

std::vector<bool> AreBeyond(const std::vector<double>& normalized) {
  std::vector<bool> are_beyond;
  for (const double value : normalized) are_beyond.push_back(std::abs(value) > kMaxSizeSigmas);
  return are_beyond;
}

struct SizeScatter {
  double sum_of_squares = 0.0;
  double degrees_of_freedom = 0.0;

  // Widened by Student's t, because a few values may hide a larger scatter.
  double Widened() const {
    return StudentFactor(degrees_of_freedom) * std::sqrt(sum_of_squares / degrees_of_freedom);
  }

  // Whether values with a standard deviation of 1 scatter as far in fewer than 0.1 % of the cases.
  bool IsBeyondChance() const {
    constexpr double kChance = 1e-3;
    const boost::math::chi_squared distribution(degrees_of_freedom);
    return sum_of_squares > boost::math::quantile(boost::math::complement(distribution, kChance));
  }
};

// The deviations that are not left out, in combinations whose errors are independent.
class IndependentDeviations {
 public:
  IndependentDeviations(const Deviations& deviations, const std::vector<MarkerSize>& sizes,
                        const std::vector<bool>& is_left_out) {
    MarkerIdxs idxs;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      if (!is_left_out[i]) idxs.push_back(i);
    }
    const auto num = static_cast<Eigen::Index>(idxs.size());
    // Multiplied by the roots of the numbers of sides, so that all have the same variance of print.
    Eigen::VectorXd roots(num), values(num);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(num, num);  // the lower triangle
    for (Eigen::Index row = 0; row < num; ++row) {
      const std::size_t i = idxs[static_cast<std::size_t>(row)];
      roots[row] = std::sqrt(sizes[i].num_sides);
      values[row] = roots[row] * deviations.values[i];
      covariance(row, row) = sizes[i].num_sides * deviations.variances[i];
      for (Eigen::Index column = 0; column < row; ++column) {
        const std::size_t j = idxs[static_cast<std::size_t>(column)];
        covariance(row, column) =
            roots[row] * roots[column] * deviations.shared[i].dot(deviations.shared[j]);
      }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
    values_ = eigen.eigenvectors().transpose() * values;
    variances_ = eigen.eigenvalues().cwiseMax(0.0);
    degrees_of_freedom_ =
        std::max(1.0, static_cast<double>(num) - static_cast<double>(deviations.num_groups));
  }

  // In sigmas of image noise and print together.
  Eigen::ArrayXd Normalized(double tolerance) const {
    return values_ / (variances_ + tolerance * tolerance).sqrt();
  }

  SizeScatter Scatter(double tolerance) const {
    return {Normalized(tolerance).square().sum(), degrees_of_freedom_};
  }

 private:
  Eigen::ArrayXd values_, variances_;
  double degrees_of_freedom_ = 0.0;
};

struct MeasuredSides {
  int count = 0;
  double mean_ratio = 0.0;   // to the printed length, or on a curved surface to the chord
  Eigen::VectorXd gradient;  // of mean_ratio by the marker's coordinates
  double shortest_m = std::numeric_limits<double>::infinity(), longest_m = 0.0;
};

MeasuredSides MeasureSides(const MarkerBlock& marker) {
  const auto sides = MarkerPriorError::Sides(marker.corners);
  MeasuredSides measured;
  measured.count = static_cast<int>(sides.size());
  measured.gradient = Eigen::VectorXd::Zero(marker.NumCoordinates());
  for (const auto& [a, b] : sides) {
    const Eigen::Vector3d side = CornerPosition(marker, b) - CornerPosition(marker, a);
    measured.shortest_m = std::min(measured.shortest_m, side.norm());
    measured.longest_m = std::max(measured.longest_m, side.norm());
    const int corner = marker.corners[static_cast<std::size_t>(a)];
    const double chord_m =
        marker.length_m * marker.chords.side_ratios[static_cast<std::size_t>(corner - 1)];
    const double weight = 1.0 / (measured.count * chord_m);
    measured.mean_ratio += weight * side.norm();
    measured.gradient.segment<3>(3 * a) -= weight * side.normalized();
    measured.gradient.segment<3>(3 * b) += weight * side.normalized();
  }
  return measured;
}

// Whether at least two thirds of the markers are not contradicting.
bool MostAgree(const std::vector<bool>& is_contradicting) {
  const auto num = std::count(is_contradicting.begin(), is_contradicting.end(), true);
  return 3 * static_cast<std::size_t>(num) <= is_contradicting.size();
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

Eigen::SparseMatrix<double> SizesByPoints(const MarkerState& state,
                                          const MarkerCovariance& covariance) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < state.markers.size(); ++i) {
    const Eigen::VectorXd gradient = MeasureSides(state.markers[i]).gradient;
    for (Eigen::Index k = 0; k < gradient.size(); ++k) {
      entries.emplace_back(static_cast<Eigen::Index>(i), covariance.begins[i] + k, gradient[k]);
    }
  }
  Eigen::SparseMatrix<double> by_points(static_cast<Eigen::Index>(state.markers.size()),
                                        covariance.begins.back());
  by_points.setFromTriplets(entries.begin(), entries.end());
  return by_points;
}

std::vector<MarkerSize> MeasureMarkers(const MarkerState& state, const MarkerCovariance& covariance,
                                       double correlation_factor,
                                       const std::map<int, double>& inset_sigmas,
                                       double print_resolution_m) {
  std::vector<MarkerSize> sizes;
  for (std::size_t i = 0; i < state.markers.size(); ++i) {
    const MarkerBlock& marker = state.markers[i];
    const MeasuredSides sides = MeasureSides(marker);
    if (sides.count == 0) continue;
    MarkerSize size;
    size.marker_id = marker.marker_id;
    size.part = marker.part;
    size.num_sides = sides.count;
    size.ratio = sides.mean_ratio;
    size.unevenness = (sides.longest_m - sides.shortest_m) / marker.length_m;
    const Eigen::VectorXd& gradient = sides.gradient;
    const auto found = inset_sigmas.find(marker.marker_id);
    const double inset_sigma = found == inset_sigmas.end() ? 0.0 : found->second;
    size.block_variance =
        std::pow(correlation_factor, 2) * gradient.dot(covariance.marker_blocks[i] * gradient) +
        inset_sigma * inset_sigma +
        std::pow(print_resolution_m / marker.length_m, 2) / size.num_sides;
    size.by_factor.resize(covariance.factor.cols() + 1);
    size.by_factor << correlation_factor * (covariance.FactorOf(i).transpose() * gradient),
        inset_sigma;
    sizes.push_back(std::move(size));
  }
  return sizes;
}

Deviations FindDeviations(const std::vector<MarkerSize>& sizes) {
  Deviations deviations(sizes.size());
  Compare(sizes, AllOf(sizes), AllOf(sizes), 0.0, &deviations);
  deviations.num_groups = 1;
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
      ++deviations.num_groups;
    } else {
      Compare(sizes, idxs, AllOf(sizes), std::pow(part_scale_sigma, 2), &deviations);
    }
  }
  return deviations;
}

SizeAgreement JudgeDeviations(const Deviations& deviations, const std::vector<MarkerSize>& sizes,
                              double print_tolerance) {
  constexpr std::size_t kManyOfGroup = 10;
  constexpr double kMaxScatter = 1.3;
  const auto normalize = [&](double tolerance) { return Normalize(deviations, sizes, tolerance); };
  // Deviations from the median of few markers are too small. The factor is about that of Croux and
  // Rousseeuw ("Time-efficient algorithms for two highly robust estimators of scale", 1992).
  const double for_few =
      static_cast<double>(sizes.size()) / static_cast<double>(sizes.size() - deviations.num_groups);
  const double robust_tolerance = ExplainingTolerance(print_tolerance, [&](double tolerance) {
    return for_few * RobustSigma(normalize(tolerance));
  });
  std::vector<bool> is_beyond = AreBeyond(normalize(robust_tolerance));
  const bool most_agree = MostAgree(is_beyond);
  if (!most_agree) is_beyond.assign(sizes.size(), false);
  const bool are_many = sizes.size() >= kManyOfGroup * deviations.num_groups;
  const IndependentDeviations independent(deviations, sizes, is_beyond);
  const Eigen::ArrayXd normalized = independent.Normalized(print_tolerance);
  const bool is_wide = !are_many || !most_agree ||
                       for_few * RobustSigma({normalized.begin(), normalized.end()}) > kMaxScatter;
  SizeAgreement agreement;
  agreement.scatters_more = are_many
                                ? is_wide && independent.Scatter(print_tolerance).IsBeyondChance()
                                : !MostAgree(AreBeyond(normalize(print_tolerance)));
  agreement.print_tolerance =
      is_wide ? ExplainingTolerance(
                    print_tolerance,
                    [&](double tolerance) { return independent.Scatter(tolerance).Widened(); })
              : print_tolerance;
  agreement.sigmas = normalize(agreement.print_tolerance);
  agreement.is_contradicting = AreBeyond(agreement.sigmas);
  if (!most_agree) agreement.is_contradicting = is_beyond;
  return agreement;
}

}  // namespace velamap
