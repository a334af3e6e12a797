#include "exporters/datum/datum_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "importer/geometry/alignment.h"
#include "importer/geometry/least_squares.h"
#include "importer/geometry/pose_step.h"
#include "importer/geometry/units.h"
#include "importer/layout/known_point.h"

namespace velamap {
namespace {

using PoseMatrix = Eigen::Matrix<double, 6, 6>;
using ByPose = Eigen::Matrix<double, Eigen::Dynamic, 6>;

// Least certainty of a determined motion, as a share of the radius: 3 degrees.
constexpr double kMaxOpen = 0.05;

// The inverse of the Cholesky factor of a covariance: whitens residuals. Without the correlations
// if rounding has made the matrix indefinite.
Eigen::MatrixXd Whitener(const Eigen::MatrixXd& covariance) {
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  if (factor.info() != Eigen::Success) {
    return covariance.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
  }
  return factor.matrixL().solve(Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols()));
}

// The same for independent points whose sigma does not depend on the direction, so that it holds
// for every pose.
Eigen::MatrixXd PlainWhitener(const DatumPoints& points, const PointSet& set) {
  std::vector<double> weights;
  for (const std::size_t i : set) {
    const DatumPoint& point = points.points[i];
    const auto row = static_cast<Eigen::Index>(3 * i);
    const double variance =
        point.sigma_m * point.sigma_m + points.covariance_m2.diagonal().segment<3>(row).mean();
    for (const auto& known : point.known_m) {
      if (known) weights.push_back(1.0 / std::sqrt(variance));
    }
  }
  return Eigen::Map<Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size()))
      .asDiagonal();
}

// See least_squares.h. Steps are those of DatumEquations::by_pose, m.
struct DatumProblem : LeastSquaresProblem<6> {
  using Parameters = Rigid3;

  const DatumPoints& points;
  const PointSet& set;
  const Eigen::MatrixXd whitener;

  DatumProblem(const DatumPoints& all, const PointSet& chosen, Eigen::MatrixXd whitening)
      : points(all), set(chosen), whitener(std::move(whitening)) {}

  void Evaluate(const Rigid3& pose, bool, Equations* equations) const {
    constexpr double kRegularization = 1e-12;
    *equations = {};
    const DatumEquations linear = Linearize(points, set, pose);
    const ByPose jacobian = whitener * linear.by_pose;
    const Eigen::VectorXd residuals = whitener * linear.residuals_m;
    equations->Add(jacobian, residuals);
    // For motions that no coordinate sees.
    equations->AddToDiagonal(kRegularization * equations->hessian().trace());
  }

  Rigid3 Plus(const Rigid3& pose, const Step& step) const {
    return {PlusRotation(pose.rotation, step.head<3>() / points.radius_m),
            pose.translation + step.tail<3>()};
  }
};

DatumPose Minimize(const DatumProblem& problem, Rigid3 pose) {
  LeastSquaresOptions options;
  options.max_iterations = 60;
  options.min_step = 1e-12 * problem.points.radius_m;
  DatumProblem::Equations equations;
  MinimizeSquares(options, problem, &pose, &equations);
  problem.Evaluate(pose, false, &equations);
  return {pose, 2 * equations.cost()};
}

// The closed form, for three or more points with all coordinates that span a plane.
std::optional<Rigid3> ClosedForm(const DatumPoints& points, const PointSet& set) {
  std::vector<Eigen::Vector3d> x_m, known_m;
  std::vector<double> weights;
  for (const std::size_t i : set) {
    const auto& known = points.points[i].known_m;
    if (!known[0] || !known[1] || !known[2]) continue;
    x_m.push_back(points.points[i].x_m);
    known_m.emplace_back(*known[0], *known[1], *known[2]);
    weights.push_back(std::pow(points.points[i].sigma_m, -2));
  }
  if (!HasSpread(x_m)) return std::nullopt;
  return EstimateRigid3(x_m, known_m, weights);
}

// The 24 turns of a cube onto itself.
std::vector<Eigen::Quaterniond> CubeRotations() {
  const auto turn = [](int quarters, int axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(quarters * 0.5 * kPi, Eigen::Vector3d::Unit(axis)));
  };
  std::vector<Eigen::Quaterniond> rotations;
  for (int face = 0; face < 6; ++face) {
    const Eigen::Quaterniond to_face = face < 4 ? turn(face, 0) : turn(2 * face - 9, 1);
    for (int quarters = 0; quarters < 4; ++quarters) {
      rotations.push_back(to_face * turn(quarters, 2));
    }
  }
  return rotations;
}

// The mean shift that the coordinates of each axis ask for after the rotation.
Rigid3 Shifted(const DatumPoints& points, const PointSet& set, const Eigen::Quaterniond& rotation) {
  Rigid3 pose{rotation, Eigen::Vector3d::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    double sum = 0.0;
    int count = 0;
    for (const std::size_t i : set) {
      const auto& known = points.points[i].known_m[static_cast<std::size_t>(axis)];
      if (!known) continue;
      sum += *known - (rotation * points.points[i].x_m)[axis];
      ++count;
    }
    if (count > 0) pose.translation[axis] = sum / count;
  }
  return pose;
}

// The directions in the span of the columns, which are orthonormal: the axes where these span it.
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

// The sum of squares of a point, of `num_coordinates` degrees of freedom, as in SigmasOff().
double InSigmas(double squared, int num_coordinates) {
  // Roots of the 99.73 % quantiles of chi-squared.
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
};

SetSystem MakeSystem(const DatumPoints& points, const DatumEquations& equations,
                     const Eigen::MatrixXd& covariance) {
  SetSystem system{Whitener(covariance), {}, {}, {}};
  system.by_pose = system.whitener * equations.by_pose;
  system.residuals = system.whitener * equations.residuals_m;
  PoseMatrix normal = system.by_pose.transpose() * system.by_pose;
  // Bounds what the equations leave open: far beyond the size of the shape, above the rounding.
  normal.diagonal().array() += std::pow(1e3 * points.radius_m, -2) + 1e-12 * normal.trace();
  system.pose_covariance = normal.llt().solve(PoseMatrix::Identity());
  return system;
}

// Each point of the set against the others: its row of the whitened residuals after adjustment,
// over what it would be for a right point.
std::vector<double> SigmasOfSet(const SetSystem& system, const std::vector<Eigen::Index>& begins) {
  constexpr double kMinRedundancy = 1e-6;  // less is rounding
  const Eigen::VectorXd adjusted =
      system.residuals -
      system.by_pose * (system.pose_covariance * (system.by_pose.transpose() * system.residuals));
  const Eigen::VectorXd weighted = system.whitener.transpose() * adjusted;
  const ByPose by_pose = system.whitener.transpose() * system.by_pose;
  std::vector<double> sigmas;
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    const Eigen::Index begin = begins[i], size = begins[i + 1] - begin;
    const auto columns = system.whitener.middleCols(begin, size);
    const Eigen::MatrixXd weight = columns.transpose() * columns;
    const auto by_rows = by_pose.middleRows(begin, size);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> redundancy(
        weight - by_rows * system.pose_covariance * by_rows.transpose());
    const Eigen::VectorXd along =
        redundancy.eigenvectors().transpose() * weighted.segment(begin, size);
    double squared = 0.0;
    int num_checked = 0;
    for (Eigen::Index k = 0; k < size; ++k) {
      if (redundancy.eigenvalues()[k] < kMinRedundancy * weight.trace()) continue;
      squared += along[k] * along[k] / redundancy.eigenvalues()[k];
      ++num_checked;
    }
    sigmas.push_back(InSigmas(squared, num_checked));
  }
  return sigmas;
}

}  // namespace

std::vector<DatumPose> FindPoses(const DatumPoints& points, const PointSet& set) {
  constexpr double kSameAngle = 1e-3;  // rad
  const DatumProblem problem(points, set, PlainWhitener(points, set));
  if (const auto closed_form = ClosedForm(points, set)) return {Minimize(problem, *closed_form)};
  std::vector<DatumPose> found;
  for (const Eigen::Quaterniond& rotation : CubeRotations()) {
    found.push_back(Minimize(problem, Shifted(points, set, rotation)));
  }
  std::stable_sort(found.begin(), found.end(), [](const DatumPose& a, const DatumPose& b) {
    return a.squared_sigmas < b.squared_sigmas;
  });
  std::vector<DatumPose> distinct;
  for (const DatumPose& pose : found) {
    const bool is_new = std::none_of(distinct.begin(), distinct.end(), [&](const DatumPose& other) {
      return AngularDistance(pose.pose, other.pose) < kSameAngle;
    });
    if (is_new) distinct.push_back(pose);
  }
  return distinct;
}

DatumPose AdjustPose(const DatumPoints& points, const PointSet& set, Rigid3 pose) {
  constexpr int kNumRounds = 2;  // the covariance hardly changes with the pose
  DatumPose adjusted{pose, 0.0};
  for (int round = 0; round < kNumRounds; ++round) {
    const DatumProblem problem(points, set,
                               Whitener(ResidualCovariance(points, set, adjusted.pose.rotation)));
    adjusted = Minimize(problem, adjusted.pose);
  }
  return adjusted;
}

std::vector<double> SigmasOff(const DatumPoints& points, const PointSet& set, const Rigid3& pose) {
  const PointSet all = AllOf(points);
  const DatumEquations equations = Linearize(points, all, pose);
  const Eigen::MatrixXd covariance = ResidualCovariance(points, all, pose.rotation);
  std::vector<Eigen::Index> rows;
  for (const std::size_t i : set) {
    for (Eigen::Index row = equations.begins[i]; row < equations.begins[i + 1]; ++row) {
      rows.push_back(row);
    }
  }
  const DatumEquations of_set = Linearize(points, set, pose);
  const SetSystem system = MakeSystem(points, of_set, covariance(rows, rows));
  const std::vector<double> sigmas_of_set = SigmasOfSet(system, of_set.begins);
  // Derivative of the adjusted pose by the residuals of the set, apart from the sign.
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

std::string OpenMotions(const DatumPoints& points, const PointSet& set, const Rigid3& pose) {
  const SetSystem system = MakeSystem(points, Linearize(points, set, pose),
                                      ResidualCovariance(points, set, pose.rotation));
  const Eigen::SelfAdjointEigenSolver<PoseMatrix> motions(system.pose_covariance);
  const double limit_m2 = std::pow(kMaxOpen * points.radius_m, 2);
  const auto num_open = (motions.eigenvalues().array() > limit_m2).count();
  if (num_open == 0) return "";
  const Eigen::MatrixXd open = motions.eigenvectors().rightCols(num_open);
  // Splits them into those with a turn and pure shifts.
  constexpr double kMinTurn = 0.1;
  const Eigen::JacobiSVD<Eigen::MatrixXd> turns(open.topRows(3),
                                                Eigen::ComputeThinU | Eigen::ComputeFullV);
  const auto num_turns = (turns.singularValues().array() > kMinTurn).count();
  std::vector<std::string> names;
  const Eigen::MatrixXd shifts = open * turns.matrixV().rightCols(num_open - num_turns);
  for (const std::string& name : DirectionNames(shifts.bottomRows(3))) {
    names.push_back("a shift along " + name);
  }
  for (const std::string& name : DirectionNames(turns.matrixU().leftCols(num_turns))) {
    names.push_back("a turn about " + name);
  }
  return fmt::format("{}", fmt::join(names, " and "));
}

std::optional<AskedGrowth> GrowthAskedFor(const DatumPoints& points, const PointSet& set,
                                          const Rigid3& pose) {
  constexpr double kMaxSigma = 0.5;
  const DatumEquations equations = Linearize(points, set, pose);
  const SetSystem system =
      MakeSystem(points, equations, ResidualCovariance(points, set, pose.rotation));
  const Eigen::VectorXd by_scale = system.whitener * equations.by_scale_m;
  // What the pose cannot take up.
  const auto without_pose = [&system](const Eigen::VectorXd& values) -> Eigen::VectorXd {
    return values -
           system.by_pose * (system.pose_covariance * (system.by_pose.transpose() * values));
  };
  const double weight = by_scale.dot(without_pose(by_scale));
  if (!(weight * kMaxSigma * kMaxSigma > 1)) return std::nullopt;
  return AskedGrowth{-by_scale.dot(without_pose(system.residuals)) / weight,
                     1.0 / std::sqrt(weight)};
}

}  // namespace velamap
