#include "reconstruct/registration/track_smoothing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/LU>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

constexpr Eigen::Index kMaxNumPowers = 4;

Eigen::ArrayXd InUnits(const std::vector<double>& times_s, double unit_s) {
  return Eigen::Map<const Eigen::ArrayXd>(times_s.data(),
                                          static_cast<Eigen::Index>(times_s.size())) /
         unit_s;
}

// The covariance of two places of the motion at times this far apart, apart from a cubic
// polynomial, about which nothing is assumed; and its derivatives.
Eigen::ArrayXd Covariance(const Eigen::ArrayXd& times) { return times.abs().pow(7) / 10080; }
Eigen::ArrayXd CovarianceRate(const Eigen::ArrayXd& times) {
  return times.abs().pow(5) * times / 1440;
}
Eigen::ArrayXd CovarianceAcceleration(const Eigen::ArrayXd& times) {
  return times.abs().pow(5) / 240;
}
Eigen::ArrayXd CovarianceJerk(const Eigen::ArrayXd& times) {
  return times.abs().pow(3) * times / 48;
}

// The inverse of the equations of universal kriging: the covariance of the places, bordered by the
// polynomials.
Eigen::MatrixXd InvertEquations(const Eigen::ArrayXd& times, double noise_ratio) {
  const Eigen::Index num_times = times.size();
  const Eigen::Index num_powers = std::min(num_times, kMaxNumPowers);
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(num_times + num_powers, num_times + num_powers);
  for (Eigen::Index i = 0; i < num_times; ++i) {
    equations.col(i).head(num_times) = Covariance(times - times[i]);
    equations(i, i) += noise_ratio;
  }
  for (Eigen::Index power = 0; power < num_powers; ++power) {
    const Eigen::VectorXd powers = times.pow(static_cast<double>(power));
    equations.col(num_times + power).head(num_times) = powers;
    equations.row(num_times + power).head(num_times) = powers.transpose();
  }
  return equations.fullPivLu().inverse();
}

// How well a model predicts the middle places of the windows.
struct Prediction {
  double motion_variance = 0.0;  // the most likely one
  double badness = 0.0;          // minus the logarithm of the likelihood
};

Prediction Predict(const std::vector<TrackWindow>& windows, double unit_s, double noise_ratio) {
  constexpr double kMedianOfSquare = 0.4549;  // chi-squared with one degree of freedom
  const auto num_windows = static_cast<double>(windows.size());
  Prediction result;
  for (const TrackWindow& window : windows) {
    const Eigen::ArrayXd times = InUnits(window.times_s, unit_s);
    const Eigen::RowVectorXd row = InvertEquations(times, noise_ratio)
                                       .row(static_cast<Eigen::Index>(window.middle_idx))
                                       .head(times.size());
    const double precision = row[static_cast<Eigen::Index>(window.middle_idx)];
    const Eigen::ArrayXd squares = (window.places_px * row.transpose()).array().square();
    result.motion_variance +=
        Median({squares.begin(), squares.end()}) / (kMedianOfSquare * precision * num_windows);
    result.badness -= std::log(precision);
  }
  result.badness += num_windows * std::log(result.motion_variance);
  return result;
}

}  // namespace

DerivativeWeights WeighPlaces(const std::vector<double>& times_s, const TrackModel& model) {
  const Eigen::ArrayXd times = InUnits(times_s, model.unit_s);
  const Eigen::Index num_times = times.size();
  const Eigen::MatrixXd inverse = InvertEquations(times, model.noise_ratio);
  Eigen::MatrixX3d derivatives = Eigen::MatrixX3d::Zero(inverse.rows(), 3);
  derivatives.col(0).head(num_times) = CovarianceRate(-times);
  derivatives.col(1).head(num_times) = CovarianceAcceleration(times);
  derivatives.col(2).head(num_times) = CovarianceJerk(-times);
  derivatives(num_times + 1, 0) = 1;
  derivatives(num_times + 2, 1) = 2;
  if (num_times >= kMaxNumPowers) derivatives(num_times + 3, 2) = 6;
  const Eigen::MatrixX3d solution = inverse * derivatives;
  const double unit_s2 = model.unit_s * model.unit_s;
  DerivativeWeights weights;
  weights.values = solution.topRows(num_times);
  weights.values.col(0) /= model.unit_s;
  weights.values.col(1) /= unit_s2;
  weights.values.col(2) /= unit_s2 * model.unit_s;
  if (num_times >= kMaxNumPowers) {
    const double variance = -solution.col(0).dot(derivatives.col(0));
    const double of_noise = model.noise_ratio * solution.col(0).head(num_times).squaredNorm();
    weights.noise_variance = model.motion_variance / unit_s2 * of_noise;
    weights.motion_variance = model.motion_variance / unit_s2 * std::max(0.0, variance - of_noise);
  }
  return weights;
}

TrackModel FitTrackModel(const std::vector<TrackWindow>& windows) {
  // The range extends from places without errors to motions without accelerations over a dozen
  // frames. A factor of four changes the shortest period that a spline follows by a fifth.
  constexpr int kLeastExponent = -10, kLargestExponent = 13;
  std::vector<double> steps_s;
  for (const TrackWindow& window : windows) {
    steps_s.push_back((window.times_s.back() - window.times_s.front()) /
                      static_cast<double>(window.times_s.size() - 1));
  }
  constexpr double kRoundingErrors = 1e-6;
  const auto num_windows = static_cast<double>(windows.size());
  TrackModel model;
  model.unit_s = Median(std::move(steps_s));
  double least_badness = std::numeric_limits<double>::infinity();
  for (int exponent = kLeastExponent; exponent <= kLargestExponent; ++exponent) {
    const double noise_ratio = std::pow(4.0, exponent);
    const Prediction prediction = Predict(windows, model.unit_s, noise_ratio);
    // One window of five frames fits all ratios equally well.
    if (!(prediction.badness < least_badness - kRoundingErrors * num_windows)) continue;
    least_badness = prediction.badness;
    model.noise_ratio = noise_ratio;
    model.motion_variance = prediction.motion_variance;
  }
  return model;
}

}  // namespace velamap
