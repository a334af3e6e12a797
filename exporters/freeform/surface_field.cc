#include "exporters/freeform/surface_field.h"

#include <algorithm>
#include <cmath>

#include "importer/base/error.h"
#include "importer/base/parallel.h"
#include "importer/base/statistics.h"

namespace velamap {
namespace {

// The function is not an exact distance, so its slope along a normal need not be exactly 1.
constexpr double kSlopeSigma = 0.1;
constexpr double kMinSigma = 1e-5;  // in normalized coordinates

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
  constexpr double kGuess = 1e-3;  // initial value of an unknown sigma
  const double default_sigma_m = has_sigmas ? Median(known_sigmas_m) : kGuess * scale_m_;
  const auto num_points = static_cast<Eigen::Index>(points.size());
  const Eigen::Index num_rows = num_points + static_cast<Eigen::Index>(normals.size());
  rows_.places.resize(num_rows, 3);
  rows_.directions.setZero(num_rows, 3);
  rows_.targets.setZero(num_rows);
  sigmas_.setConstant(num_rows, kSlopeSigma);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const FieldPoint& point = points[static_cast<std::size_t>(i)];
    rows_.places.row(i) = Normalized(point.x_in_shape_m);
    sigmas_(i) = std::max(point.sigma_m.value_or(default_sigma_m) / scale_m_, kMinSigma);
  }
  for (Eigen::Index i = num_points; i < num_rows; ++i) {
    const FieldNormal& normal = normals[static_cast<std::size_t>(i - num_points)];
    rows_.places.row(i) = Normalized(normal.x_in_shape_m);
    rows_.directions.row(i) = normal.normal;
    rows_.targets(i) = 1.0;
  }
  const FieldParameters parameters = MaximizeLikelihood(rows_, sigmas_, has_sigmas);
  sigmas_.head(num_points) =
      (parameters.sigma_factor * sigmas_.head(num_points)).cwiseMax(kMinSigma);
  amplitude_ = parameters.amplitude;
  solution_ = SolveField(rows_, sigmas_, amplitude_);
}

FieldValue SurfaceField::Evaluate(const Eigen::Vector3d& x_in_shape_m) const {
  const Eigen::Vector3d x = Normalized(x_in_shape_m);
  double value = DriftValue(x).dot(solution_.drift);
  Eigen::Vector3d gradient = DriftGradient(x) * solution_.drift;
  for (Eigen::Index i = 0; i < solution_.weights.size(); ++i) {
    const Eigen::Vector3d d = x - rows_.places.row(i).transpose();
    const double r = d.norm();
    if (rows_.IsValue(i)) {
      value += solution_.weights(i) * ThinPlateCovariance(r);
      gradient += solution_.weights(i) * ThinPlateSlope(r) * d;
    } else {
      const Eigen::Vector3d normal = rows_.directions.row(i);
      const double along = d.dot(normal);
      value -= solution_.weights(i) * ThinPlateSlope(r) * along;
      gradient -=
          solution_.weights(i) * (ThinPlateSlope(r) * normal + (r > 0 ? 6 * along / r : 0.0) * d);
    }
  }
  return {scale_m_ * value, gradient};
}

std::vector<double> SurfaceField::Sigmas(const std::vector<Eigen::Vector3d>& points_in_shape_m,
                                         int num_threads) const {
  constexpr std::size_t kPerBlock = 64;  // right-hand sides solved together, which is faster
  const double variance = amplitude_ * amplitude_;
  std::vector<double> sigmas_m(points_in_shape_m.size());
  ParallelFor((sigmas_m.size() + kPerBlock - 1) / kPerBlock, num_threads, [&](std::size_t block) {
    const std::size_t first = block * kPerBlock;
    const std::size_t size = std::min(kPerBlock, sigmas_m.size() - first);
    Eigen::MatrixXd whitened(solution_.weights.size(), size);
    Eigen::MatrixXd drift(kNumDrift, size);
    for (std::size_t k = 0; k < size; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const Eigen::Vector3d x = Normalized(points_in_shape_m[first + k]);
      drift.col(column) = DriftValue(x);
      for (Eigen::Index i = 0; i < solution_.weights.size(); ++i) {
        const Eigen::Vector3d d = x - rows_.places.row(i).transpose();
        const double r = d.norm();
        whitened(i, column) =
            variance * (rows_.IsValue(i) ? ThinPlateCovariance(r)
                                         : -ThinPlateSlope(r) * rows_.directions.row(i).dot(d));
      }
    }
    solution_.covariance.matrixL().solveInPlace(whitened);
    const Eigen::MatrixXd beyond = drift - solution_.whitened_drift.transpose() * whitened;
    const Eigen::MatrixXd solved = solution_.drift_precision.solve(beyond);
    for (std::size_t k = 0; k < size; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const double of_value = variance * ThinPlateCovariance(0) -
                              whitened.col(column).squaredNorm() +
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
