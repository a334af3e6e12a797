#include "exporters/datum/datum_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "exporters/datum/datum_pose.h"
#include "importer/geometry/symmetric_eigen.h"
#include "importer/layout/known_point.h"

namespace velamap {
namespace {

using PoseMatrix = Eigen::Matrix<double, 6, 6>;
using ByPose = Eigen::Matrix<double, Eigen::Dynamic, 6>;

// The largest sigma of a motion that counts as determined, as a fraction of the radius; 3 degrees.
constexpr double kMaxOpen = 0.05;

// Names the directions in the span of the columns, which are orthonormal. The names are axes if
// these span the same space.
std::vector<std::string> DirectionNames(const Eigen::Matrix3Xd& directions) {
  constexpr double kAlmostOne = 0.998;  // 3.6 degrees
  std::vector<std::string> names;
  for (int axis = 0; axis < 3; ++axis) {
    if (directions.row(axis).norm() > kAlmostOne) {
      names.push_back(kAxisNames[static_cast<std::size_t>(axis)]);
    }
  }
  if (static_cast<Eigen::Index>(names.size()) == directions.cols()) return names;
  names.clear();
  for (const auto& direction : directions.colwise()) {
    names.push_back(fmt::format("the direction ({:.2f} {:.2f} {:.2f})", direction.x(),
                                direction.y(), direction.z()));
  }
  return names;
}

// Converts a chi-squared value of `num_coordinates` degrees of freedom to the number of sigmas that
// BaardaStatistics() returns.
double InSigmas(double squared, int num_coordinates) {
  // Square roots of the 99.73 % quantiles of chi-squared for 1, 2 and 3 degrees of freedom.
  constexpr double kThreeSigmas[] = {3.0, 3.4393, 3.7625};
  if (num_coordinates == 0) return 0.0;
  return 3.0 * std::sqrt(std::max(0.0, squared)) / kThreeSigmas[num_coordinates - 1];
}

// The whitened equations of the set at a pose.
struct SetSystem {
  Eigen::MatrixXd whitener;
  ByPose by_pose;              // whitened
  Eigen::VectorXd residuals;   // whitened
  PoseMatrix pose_covariance;  // of the adjusted pose, m^2

  // The part of whitened values that a change of the pose cannot compensate.
  Eigen::VectorXd WithoutPose(const Eigen::VectorXd& values) const {
    return values - by_pose * (pose_covariance * (by_pose.transpose() * values));
  }
};

SetSystem MakeSystem(const DatumPoints& points, const DatumEquations& equations,
                     const Eigen::MatrixXd& covariance) {
  SetSystem system{Whitener(covariance), {}, {}, {}};
  system.by_pose = system.whitener * equations.by_pose;
  system.residuals = system.whitener * equations.residuals_m;
  PoseMatrix normal = system.by_pose.transpose() * system.by_pose;
  // A weak prior keeps the matrix regular if the equations leave a motion undetermined. Its sigma
  // is 1000 times the radius, or less if the prior would otherwise be lost in rounding errors.
  normal.diagonal().array() += std::pow(1e3 * points.radius_m, -2) + 1e-12 * normal.trace();
  system.pose_covariance = normal.llt().solve(PoseMatrix::Identity());
  return system;
}

// BaardaStatistics() for the points of the set: the residuals of each point after the adjustment,
// normalized by their covariance (Baarda's test).
std::vector<double> SigmasOfSet(const SetSystem& system, const std::vector<Eigen::Index>& begins) {
  constexpr double kMinRedundancy = 1e-6;  // smaller values are rounding errors
  const Eigen::VectorXd weighted =
      system.whitener.transpose() * system.WithoutPose(system.residuals);
  const ByPose by_pose = system.whitener.transpose() * system.by_pose;
  std::vector<double> sigmas;
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    const Eigen::Index begin = begins[i], size = begins[i + 1] - begin;
    const auto columns = system.whitener.middleCols(begin, size);
    const Eigen::MatrixXd weight = columns.transpose() * columns;
    const auto by_rows = by_pose.middleRows(begin, size);
    const SymmetricEigen redundancy =
        DecomposeSymmetric(weight - by_rows * system.pose_covariance * by_rows.transpose());
    const Eigen::VectorXd along = redundancy.vectors.transpose() * weighted.segment(begin, size);
    double squared = 0.0;
    int num_checked = 0;
    for (Eigen::Index k = 0; k < size; ++k) {
      if (redundancy.values[k] < kMinRedundancy * weight.trace()) continue;
      squared += along[k] * along[k] / redundancy.values[k];
      ++num_checked;
    }
    sigmas.push_back(InSigmas(squared, num_checked));
  }
  return sigmas;
}

}  // namespace

std::vector<double> BaardaStatistics(const DatumPoints& points, const PointSet& set,
                                     const Rigid3& known_from_centred) {
  PointSet all(points.points.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const DatumEquations equations = LinearizeDatum(points, all, known_from_centred);
  const Eigen::MatrixXd covariance = ResidualCovariance(points, all, known_from_centred.rotation);
  std::vector<Eigen::Index> rows;
  for (const std::size_t i : set) {
    for (Eigen::Index row = equations.begins[i]; row < equations.begins[i + 1]; ++row) {
      rows.push_back(row);
    }
  }
  const DatumEquations of_set = LinearizeDatum(points, set, known_from_centred);
  const SetSystem system = MakeSystem(points, of_set, covariance(rows, rows));
  const std::vector<double> sigmas_of_set = SigmasOfSet(system, of_set.begins);
  // The derivative of the adjusted pose with respect to the residuals of the set, with the opposite
  // sign.
  const Eigen::MatrixXd pose_by_residuals =
      system.pose_covariance * system.by_pose.transpose() * system.whitener;
  std::vector<double> sigmas(points.points.size(), 0.0);
  for (std::size_t i = 0; i < sigmas.size(); ++i) {
    const auto in_set = std::lower_bound(set.begin(), set.end(), i);
    if (in_set != set.end() && *in_set == i) {
      sigmas[i] = sigmas_of_set[static_cast<std::size_t>(in_set - set.begin())];
      continue;
    }
    const Eigen::Index begin = equations.begins[i], size = equations.begins[i + 1] - begin;
    const auto by_pose = equations.by_pose.middleRows(begin, size);
    const Eigen::MatrixXd with_set = covariance.middleRows(begin, size)(Eigen::all, rows) *
                                     (by_pose * pose_by_residuals).transpose();
    const Eigen::MatrixXd difference_covariance =
        covariance.block(begin, begin, size, size) +
        by_pose * system.pose_covariance * by_pose.transpose() - with_set - with_set.transpose();
    const Eigen::VectorXd difference = equations.residuals_m.segment(begin, size);
    const Eigen::VectorXd weighted = difference_covariance.ldlt().solve(difference);
    sigmas[i] = InSigmas(difference.dot(weighted), static_cast<int>(size));
  }
  return sigmas;
}

std::string UndeterminedMotions(const DatumPoints& points, const PointSet& set,
                                const Rigid3& known_from_centred) {
  const SetSystem system = MakeSystem(points, LinearizeDatum(points, set, known_from_centred),
                                      ResidualCovariance(points, set, known_from_centred.rotation));
  const SymmetricEigen motions = DecomposeSymmetric(system.pose_covariance);
  const double limit_m2 = std::pow(kMaxOpen * points.radius_m, 2);
  const auto num_open = (motions.values.array() > limit_m2).count();
  if (num_open == 0) return "";
  const Eigen::MatrixXd open = motions.vectors.rightCols(num_open);
  // Separates pure shifts from motions with a turn.
  constexpr double kMinTurn = 0.1;
  const Eigen::MatrixXd turn = open.topRows(3);
  const SymmetricEigen by_turn = DecomposeSymmetric(turn.transpose() * turn);
  const auto num_turns = (by_turn.values.array() > kMinTurn * kMinTurn).count();
  const Eigen::MatrixXd shifts = open * by_turn.vectors.leftCols(num_open - num_turns);
  const Eigen::MatrixXd turns = turn * by_turn.vectors.rightCols(num_turns);
  std::vector<std::string> names;
  for (const std::string& name : DirectionNames(shifts.bottomRows(3))) {
    names.push_back("a shift along " + name);
  }
  for (const std::string& name : DirectionNames(turns.colwise().normalized())) {
    names.push_back("a turn about " + name);
  }
  return fmt::format("{}", fmt::join(names, " and "));
}

std::optional<UncertainValue> EstimateScaleChange(const DatumPoints& points, const PointSet& set,
                                                  const Rigid3& known_from_centred) {
  constexpr double kMaxSigma = 0.5;
  const DatumEquations equations = LinearizeDatum(points, set, known_from_centred);
  const SetSystem system =
      MakeSystem(points, equations, ResidualCovariance(points, set, known_from_centred.rotation));
  const Eigen::VectorXd by_scale = system.whitener * equations.by_scale_m;
  const double weight = by_scale.dot(system.WithoutPose(by_scale));
  if (!(weight * kMaxSigma * kMaxSigma > 1)) return std::nullopt;
  return UncertainValue{-by_scale.dot(system.WithoutPose(system.residuals)) / weight,
                        1.0 / std::sqrt(weight)};
}

}  // namespace velamap
