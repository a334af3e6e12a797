#include "exporters/freeform/surface_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "importer/base/error.h"
#include "importer/base/parallel.h"
#include "importer/base/statistics.h"

namespace velamap {
namespace {

constexpr int kNumDrift = 10;  // monomials up to the second degree
// The prior of the polynomial: in normalized coordinates its coefficients are of the order of 1.
constexpr double kDriftSigma = 10.0;
// D of the covariance. All distances between points of the unit ball are below it.
constexpr double kDiameter = 2.5;
// The slope along a normal need not be 1: the function is no exact distance.
constexpr double kSlopeSigma = 0.1;
constexpr double kMinSigma = 1e-5;
// A subset of the rows determines the amplitude well enough. The time of one evaluation of the
// likelihood grows with the third power of their number.
constexpr Eigen::Index kMaxLikelihoodRows = 600;

using Drift = Eigen::Matrix<double, kNumDrift, 1>;

Drift DriftValue(const Eigen::Vector3d& x) {
  Drift drift;
  drift << 1, x, x.cwiseAbs2(), x.y() * x.z(), x.z() * x.x(), x.x() * x.y();
  return drift;
}

// One row per axis.
Eigen::Matrix<double, 3, kNumDrift> DriftGradient(const Eigen::Vector3d& x) {
  Eigen::Matrix<double, 3, kNumDrift> gradient;
  gradient << 0, 1, 0, 0, 2 * x.x(), 0, 0, 0, x.z(), x.y(),  //
      0, 0, 1, 0, 0, 2 * x.y(), 0, x.z(), 0, x.x(),          //
      0, 0, 0, 1, 0, 0, 2 * x.z(), x.y(), x.x(), 0;
  return gradient;
}

double Covariance(double r) {
  return (2 * r - 3 * kDiameter) * r * r + kDiameter * kDiameter * kDiameter;
}
// The derivative by the first place is this times the vector from the second place to the first.
double Slope(double r) { return 6 * (r - kDiameter); }

// Places and directions of the observations: a value where the direction is zero, else the slope
// along it.
struct Rows {
  Eigen::MatrixX3d places, directions;
  Eigen::VectorXd targets;

  Eigen::Index Size() const { return targets.size(); }
  bool IsValue(Eigen::Index i) const { return directions.row(i).isZero(0); }
};

double RowCovariance(const Rows& rows, Eigen::Index i, Eigen::Index j) {
  const Eigen::RowVector3d d = rows.places.row(i) - rows.places.row(j);
  const double r = d.norm();
  const bool i_is_value = rows.IsValue(i), j_is_value = rows.IsValue(j);
  if (i_is_value && j_is_value) return Covariance(r);
  if (i_is_value) return -Slope(r) * d.dot(rows.directions.row(j));
  if (j_is_value) return Slope(r) * d.dot(rows.directions.row(i));
  const double along_i = d.dot(rows.directions.row(i)), along_j = d.dot(rows.directions.row(j));
  return -Slope(r) * rows.directions.row(i).dot(rows.directions.row(j)) -
         (r > 0 ? 6 * along_i * along_j / r : 0.0);
}

Eigen::MatrixXd UnitCovariance(const Rows& rows) {
  Eigen::MatrixXd covariance(rows.Size(), rows.Size());
  for (Eigen::Index j = 0; j < rows.Size(); ++j) {
    for (Eigen::Index i = j; i < rows.Size(); ++i) {
      covariance(i, j) = covariance(j, i) = RowCovariance(rows, i, j);
    }
  }
  return covariance;
}

Eigen::MatrixXd DriftOf(const Rows& rows) {
  Eigen::MatrixXd drift(rows.Size(), kNumDrift);
  for (Eigen::Index i = 0; i < rows.Size(); ++i) {
    const Eigen::Vector3d x = rows.places.row(i);
    if (rows.IsValue(i)) {
      drift.row(i) = DriftValue(x);
    } else {
      drift.row(i) = rows.directions.row(i) * DriftGradient(x);
    }
  }
  return drift;
}

struct FieldSolution {
  Eigen::LLT<Eigen::MatrixXd> covariance;
  Eigen::MatrixXd whitened_drift;
  Eigen::LLT<Eigen::MatrixXd> drift_precision;
  Eigen::VectorXd drift, weights;
  double log_likelihood = 0.0;  // without its constant
};

double LogDeterminant(const Eigen::LLT<Eigen::MatrixXd>& factor) {
  return 2 * factor.matrixLLT().diagonal().array().log().sum();
}

// Rasmussen and Williams, section 2.7, with a polynomial of finite prior sigma.
FieldSolution Solve(const Eigen::MatrixXd& unit_covariance, const Eigen::MatrixXd& drift,
                    const Eigen::VectorXd& targets, const Eigen::VectorXd& sigmas,
                    double amplitude) {
  FieldSolution solution;
  Eigen::MatrixXd covariance = amplitude * amplitude * unit_covariance;
  covariance.diagonal() += sigmas.cwiseAbs2();
  solution.covariance.compute(covariance);
  VELAMAP_CHECK(solution.covariance.info() == Eigen::Success);
  const auto lower = solution.covariance.matrixL();
  solution.whitened_drift = lower.solve(drift);
  const Eigen::VectorXd whitened_targets = lower.solve(targets);
  Eigen::MatrixXd precision = solution.whitened_drift.transpose() * solution.whitened_drift;
  precision.diagonal().array() += 1 / (kDriftSigma * kDriftSigma);
  solution.drift_precision.compute(precision);
  solution.drift =
      solution.drift_precision.solve(solution.whitened_drift.transpose() * whitened_targets);
  const Eigen::VectorXd residuals = whitened_targets - solution.whitened_drift * solution.drift;
  solution.weights = amplitude * amplitude * solution.covariance.matrixU().solve(residuals);
  solution.log_likelihood =
      -0.5 * (LogDeterminant(solution.covariance) + LogDeterminant(solution.drift_precision) +
              whitened_targets.dot(residuals));
  return solution;
}

// The argument between the two with the largest value of a function that has one maximum.
template <typename Function>
double Maximize(double low, double high, const Function& function) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr double kTolerance = 0.1;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double at_a = function(a), at_b = function(b);
  while (high - low > kTolerance) {
    if (at_a > at_b) {
      high = std::exchange(b, a), at_b = at_a;
      a = high - kGolden * (high - low), at_a = function(a);
    } else {
      low = std::exchange(a, b), at_a = at_b;
      b = low + kGolden * (high - low), at_b = function(b);
    }
  }
  return (low + high) / 2;
}

struct Parameters {
  double amplitude = 1.0;
  double sigma_factor = 1.0;  // of the sigmas of the points
};

Parameters MaximizeLikelihood(const Rows& all, const Eigen::VectorXd& all_sigmas,
                              bool sigmas_are_known) {
  // Every k-th row, so that at most kMaxLikelihoodRows remain; points and normals alike.
  const Eigen::Index step = (all.Size() + kMaxLikelihoodRows - 1) / kMaxLikelihoodRows;
  const auto chosen = Eigen::seq(0, all.Size() - 1, step);
  const Rows rows = {all.places(chosen, Eigen::all), all.directions(chosen, Eigen::all),
                     all.targets(chosen)};
  const Eigen::MatrixXd covariance = UnitCovariance(rows), drift = DriftOf(rows);
  const auto log_likelihood = [&](double log_amplitude, double log_factor) {
    Eigen::VectorXd sigmas = all_sigmas(chosen);
    for (Eigen::Index i = 0; i < rows.Size(); ++i) {
      if (rows.IsValue(i)) sigmas(i) *= std::exp(log_factor);
    }
    return Solve(covariance, drift, rows.targets, sigmas, std::exp(log_amplitude)).log_likelihood;
  };
  double log_amplitude = std::log(1e-2), log_factor = 0.0;
  for (int round = 0; round < (sigmas_are_known ? 1 : 4); ++round) {
    log_amplitude =
        Maximize(std::log(1e-5), 0.0, [&](double x) { return log_likelihood(x, log_factor); });
    if (sigmas_are_known) break;
    log_factor = Maximize(std::log(1e-2), std::log(1e2),
                          [&](double x) { return log_likelihood(log_amplitude, x); });
  }
  return {std::exp(log_amplitude), std::exp(log_factor)};
}

}  // namespace

SurfaceField::SurfaceField(const std::vector<FieldPoint>& points,
                           const std::vector<FieldNormal>& normals) {
  if (points.empty() || normals.empty()) throw DataError("no marker with four corners");
  for (const FieldPoint& point : points) center_m_ += point.x_in_shape_m;
  center_m_ /= static_cast<double>(points.size());
  scale_m_ = 0.0;
  std::vector<double> known_sigmas_m;
  for (const FieldPoint& point : points) {
    scale_m_ = std::max(scale_m_, (point.x_in_shape_m - center_m_).norm());
    if (point.sigma_m) known_sigmas_m.push_back(*point.sigma_m);
  }
  if (!(scale_m_ > 0)) throw DataError("all corners are in one place");
  const bool has_sigmas = !known_sigmas_m.empty();
  constexpr double kGuess = 1e-3;  // where the search for an unknown sigma begins
  const double default_sigma_m = has_sigmas ? Median(known_sigmas_m) : kGuess * scale_m_;
  const auto num_points = static_cast<Eigen::Index>(points.size());
  const Eigen::Index num_rows = num_points + static_cast<Eigen::Index>(normals.size());
  Rows rows;
  rows.places.resize(num_rows, 3);
  rows.directions.setZero(num_rows, 3);
  rows.targets.setZero(num_rows);
  sigmas_.setConstant(num_rows, kSlopeSigma);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const FieldPoint& point = points[static_cast<std::size_t>(i)];
    rows.places.row(i) = Normalized(point.x_in_shape_m);
    sigmas_(i) = std::max(point.sigma_m.value_or(default_sigma_m) / scale_m_, kMinSigma);
  }
  for (Eigen::Index i = num_points; i < num_rows; ++i) {
    const FieldNormal& normal = normals[static_cast<std::size_t>(i - num_points)];
    rows.places.row(i) = Normalized(normal.x_in_shape_m);
    rows.directions.row(i) = normal.normal;
    rows.targets(i) = 1.0;
  }
  const Parameters parameters = MaximizeLikelihood(rows, sigmas_, has_sigmas);
  sigmas_.head(num_points) =
      (parameters.sigma_factor * sigmas_.head(num_points)).cwiseMax(kMinSigma);
  amplitude_ = parameters.amplitude;
  FieldSolution solution =
      Solve(UnitCovariance(rows), DriftOf(rows), rows.targets, sigmas_, amplitude_);
  places_ = std::move(rows.places);
  normals_ = std::move(rows.directions);
  covariance_ = std::move(solution.covariance);
  whitened_drift_ = std::move(solution.whitened_drift);
  drift_precision_ = std::move(solution.drift_precision);
  drift_ = std::move(solution.drift);
  weights_ = std::move(solution.weights);
}

FieldValue SurfaceField::Evaluate(const Eigen::Vector3d& x_in_shape_m) const {
  const Eigen::Vector3d x = Normalized(x_in_shape_m);
  double value = DriftValue(x).dot(drift_);
  Eigen::Vector3d gradient = DriftGradient(x) * drift_;
  for (Eigen::Index i = 0; i < weights_.size(); ++i) {
    const Eigen::Vector3d d = x - places_.row(i).transpose();
    const double r = d.norm();
    if (IsValue(i)) {
      value += weights_(i) * Covariance(r);
      gradient += weights_(i) * Slope(r) * d;
    } else {
      const Eigen::Vector3d normal = normals_.row(i);
      const double along = d.dot(normal);
      value -= weights_(i) * Slope(r) * along;
      gradient -= weights_(i) * (Slope(r) * normal + (r > 0 ? 6 * along / r : 0.0) * d);
    }
  }
  return {scale_m_ * value, gradient};
}

std::vector<double> SurfaceField::Sigmas(const std::vector<Eigen::Vector3d>& points_in_shape_m,
                                         int num_threads) const {
  constexpr std::size_t kPerBlock = 64;  // solved together, which is faster than one by one
  const double variance = amplitude_ * amplitude_;
  std::vector<double> sigmas_m(points_in_shape_m.size());
  ParallelFor((sigmas_m.size() + kPerBlock - 1) / kPerBlock, num_threads, [&](std::size_t block) {
    const std::size_t first = block * kPerBlock;
    const std::size_t size = std::min(kPerBlock, sigmas_m.size() - first);
    Eigen::MatrixXd whitened(weights_.size(), size);
    Eigen::MatrixXd drift(kNumDrift, size);
    for (std::size_t k = 0; k < size; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const Eigen::Vector3d x = Normalized(points_in_shape_m[first + k]);
      drift.col(column) = DriftValue(x);
      for (Eigen::Index i = 0; i < weights_.size(); ++i) {
        const Eigen::Vector3d d = x - places_.row(i).transpose();
        const double r = d.norm();
        whitened(i, column) =
            variance * (IsValue(i) ? Covariance(r) : -Slope(r) * normals_.row(i).dot(d));
      }
    }
    covariance_.matrixL().solveInPlace(whitened);
    const Eigen::MatrixXd beyond = drift - whitened_drift_.transpose() * whitened;
    const Eigen::MatrixXd solved = drift_precision_.solve(beyond);
    for (std::size_t k = 0; k < size; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const double of_value = variance * Covariance(0) - whitened.col(column).squaredNorm() +
                              beyond.col(column).dot(solved.col(column));
      const double slope = Evaluate(points_in_shape_m[first + k]).gradient.norm();
      sigmas_m[first + k] = scale_m_ * std::sqrt(std::max(0.0, of_value)) / slope;
    }
  });
  return sigmas_m;
}

std::optional<Eigen::Vector3d> SurfaceField::Project(const Eigen::Vector3d& x_in_shape_m,
                                                     double max_distance_m) const {
  constexpr int kMaxSteps = 20;
  constexpr double kConverged = 1e-9;
  Eigen::Vector3d x = x_in_shape_m;
  for (int step = 0; step < kMaxSteps; ++step) {
    const FieldValue field = Evaluate(x);
    const Eigen::Vector3d move = -field.value_m / field.gradient.squaredNorm() * field.gradient;
    x += move;
    if (!((x - x_in_shape_m).norm() <= max_distance_m)) return std::nullopt;
    if (move.norm() < kConverged * scale_m_) return x;
  }
  return std::nullopt;
}

}  // namespace velamap
