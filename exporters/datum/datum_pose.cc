#include "exporters/datum/datum_pose.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "importer/geometry/alignment.h"
#include "importer/geometry/directions.h"
#include "importer/geometry/least_squares.h"
#include "importer/geometry/pose_step.h"

namespace velamap {
namespace {

// The same as Whitener(), but for independent points with isotropic errors, so that it does not
// depend on the pose.
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

// The problem for MinimizeSquares() in least_squares.h. Steps are those of DatumEquations::by_pose,
// m.
struct DatumProblem : LeastSquaresProblem<6> {
  using Parameters = Rigid3;

  const DatumPoints& points;
  const PointSet& set;
  const Eigen::MatrixXd whitener;

  DatumProblem(const DatumPoints& all, const PointSet& chosen, Eigen::MatrixXd whitening)
      : points(all), set(chosen), whitener(std::move(whitening)) {}

  void Evaluate(const Rigid3& known_from_centred, bool, Equations* equations) const {
    constexpr double kRegularization = 1e-12;
    *equations = {};
    const DatumEquations linear = LinearizeDatum(points, set, known_from_centred);
    const Eigen::Matrix<double, Eigen::Dynamic, 6> jacobian = whitener * linear.by_pose;
    const Eigen::VectorXd residuals = whitener * linear.residuals_m;
    equations->Add(jacobian, residuals);
    // Keeps the Hessian regular if the coordinates leave a motion undetermined.
    equations->AddToDiagonal(kRegularization * equations->hessian().trace());
  }

  Rigid3 Plus(const Rigid3& known_from_centred, const Step& step) const {
    return {PlusRotation(known_from_centred.rotation, step.head<3>() / points.radius_m),
            known_from_centred.translation + step.tail<3>()};
  }
};

DatumPose Minimize(const DatumProblem& problem, Rigid3 known_from_centred) {
  LeastSquaresOptions options;
  options.max_iterations = 60;
  options.min_step = 1e-12 * problem.points.radius_m;
  DatumProblem::Equations equations;
  MinimizeSquares(options, problem, &known_from_centred, &equations);
  problem.Evaluate(known_from_centred, false, &equations);
  return {known_from_centred, 2 * equations.cost()};
}

// The closed form. It needs three or more points with all coordinates that are not on one line.
std::optional<Rigid3> ClosedForm(const DatumPoints& points, const PointSet& set) {
  std::vector<Eigen::Vector3d> x_m, known_m;
  std::vector<double> weights;
  for (const std::size_t i : set) {
    const std::optional<Eigen::Vector3d> position_m = points.points[i].KnownPosition();
    if (!position_m) continue;
    x_m.push_back(points.points[i].x_m);
    known_m.push_back(*position_m);
    weights.push_back(std::pow(points.points[i].sigma_m, -2));
  }
  if (!HasSpread(x_m)) return std::nullopt;
  return EstimateRigid3(x_m, known_m, weights);
}

// The pose with the given rotation and the translation that makes the mean residual along each axis
// zero.
Rigid3 Shifted(const DatumPoints& points, const PointSet& set, const Eigen::Quaterniond& rotation) {
  Rigid3 known_from_centred{rotation, Eigen::Vector3d::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    double sum = 0.0;
    int count = 0;
    for (const std::size_t i : set) {
      const auto& known = points.points[i].known_m[static_cast<std::size_t>(axis)];
      if (!known) continue;
      sum += *known - (rotation * points.points[i].x_m)[axis];
      ++count;
    }
    if (count > 0) known_from_centred.translation[axis] = sum / count;
  }
  return known_from_centred;
}

}  // namespace

Eigen::MatrixXd Whitener(const Eigen::MatrixXd& covariance) {
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  if (factor.info() != Eigen::Success) {
    return covariance.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
  }
  return factor.matrixL().solve(Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols()));
}

std::vector<DatumPose> FindPoses(const DatumPoints& points, const PointSet& set) {
  constexpr double kSameAngle = 1e-3;  // rad
  const DatumProblem problem(points, set, PlainWhitener(points, set));
  if (const auto closed_form = ClosedForm(points, set)) return {Minimize(problem, *closed_form)};
  std::vector<DatumPose> found;
  for (const Eigen::Matrix3d& rotation : CubeRotations()) {
    found.push_back(Minimize(problem, Shifted(points, set, Eigen::Quaterniond(rotation))));
  }
  std::stable_sort(found.begin(), found.end(), [](const DatumPose& a, const DatumPose& b) {
    return a.squared_sigmas < b.squared_sigmas;
  });
  std::vector<DatumPose> distinct;
  for (const DatumPose& pose : found) {
    const bool is_new = std::none_of(distinct.begin(), distinct.end(), [&](const DatumPose& other) {
      return AngularDistance(pose.known_from_centred, other.known_from_centred) < kSameAngle;
    });
    if (is_new) distinct.push_back(pose);
  }
  return distinct;
}

DatumPose AdjustPose(const DatumPoints& points, const PointSet& set,
                     const Rigid3& known_from_centred) {
  constexpr int kNumRounds = 2;  // the covariance hardly changes with the pose
  DatumPose adjusted{known_from_centred, 0.0};
  for (int round = 0; round < kNumRounds; ++round) {
    const DatumProblem problem(
        points, set,
        Whitener(ResidualCovariance(points, set, adjusted.known_from_centred.rotation)));
    adjusted = Minimize(problem, adjusted.known_from_centred);
  }
  return adjusted;
}

}  // namespace velamap
