#include "exporters/compare/closest_points.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "importer/base/statistics.h"
#include "importer/geometry/directions.h"
#include "importer/geometry/least_squares.h"
#include "importer/geometry/principal_axes.h"

namespace velamap {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr std::size_t kMaxCoarsePoints = 150;
constexpr int kCoarseIterations = 25;
constexpr std::size_t kNumFineStarts = 4;
constexpr double kTrim = 0.8;         // share of the points by which poses are compared
constexpr double kTukey = 4.685;      // 95 % efficiency for normal noise (Huber, 1981)
constexpr double kFloor = 1e-9;       // of the diagonal: distances below this are zero
constexpr double kConverged = 1e-8;   // of the diagonal, a step: 50 nm on a sail of 5 m
constexpr double kMaxTurn_rad = 0.5;  // of one step

// Root mean square of the smallest kTrim of the distances.
double TrimmedRms(const std::vector<PointResidual>& residuals) {
  std::vector<double> distances_m;
  for (const PointResidual& r : residuals) distances_m.push_back(std::abs(r.distance_m));
  std::sort(distances_m.begin(), distances_m.end());
  distances_m.resize(std::max<std::size_t>(
      1, static_cast<std::size_t>(kTrim * static_cast<double>(distances_m.size()))));
  return Rms(distances_m);
}

using Motion = Eigen::Matrix<double, 6, 1>;  // rotation times the radius of the points, translation

// The share of each step that is taken. When the foot of a point moves to another triangle, the
// normal changes, so whole steps may circle forever within a few hundredths of a millimetre. A step
// back halves the share, and steps in one direction restore it (like Rprop; Riedmiller and Braun,
// 1993).
class StepShare {
 public:
  double Next(const Motion& motion) {
    constexpr double kGrowth = 1.3;
    share_ = motion.dot(last_) < 0 ? share_ / 2 : std::min(1.0, kGrowth * share_);
    last_ = motion;
    return share_;
  }

 private:
  Motion last_ = Motion::Zero();
  double share_ = 1.0;
};

// Takes one Gauss-Newton step, or the part of it that `share` allows (null for all), and returns
// the largest movement of a point. MinimizeSquares() is not used, because nearest points and
// weights change with every step, so costs are not comparable: with its damping, fits from far away
// ended in worse poses.
double Step(const std::vector<PointResidual>& residuals, const std::vector<double>& weights,
            StepShare* share, Rigid3* pose) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const PointResidual& r : residuals) center += r.x_m / static_cast<double>(residuals.size());
  double radius_m = 0.0;
  for (const PointResidual& r : residuals) radius_m = std::max(radius_m, (r.x_m - center).norm());
  GaussNewtonEquations<6> equations;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const PointResidual& r = residuals[i];
    Eigen::Matrix<double, 1, 6> row;
    row << (r.x_m - center).cross(r.direction).transpose() / radius_m, r.direction.transpose();
    const double root = std::sqrt(weights[i]);
    equations.Add<1>(root * row, Eigen::Matrix<double, 1, 1>(root * r.distance_m));
  }
  // Keeps motions that the surface does not determine at zero and hardly changes the others.
  equations.AddToDiagonal(1e-9 * equations.hessian().trace());
  auto motion = SolveDamped(equations, 0.0);
  if (!motion) return 0.0;
  if (share != nullptr) *motion *= share->Next(*motion);
  const Eigen::Vector3d turn = motion->head<3>() / radius_m;
  const double angle = std::min(turn.norm(), kMaxTurn_rad);
  const Eigen::Quaterniond rotation(turn.norm() > 0 ? Eigen::AngleAxisd(angle, turn.normalized())
                                                    : Eigen::AngleAxisd::Identity());
  *pose = Rigid3{rotation, center - rotation * center + motion->tail<3>()} * *pose;
  return angle * radius_m + motion->tail<3>().norm();
}

// Alternates between weights and one step of least squares.
SurfacePose Iterate(const Points& points, const MeshDistance& mesh, const Rigid3& start,
                    bool is_fine, int num_iterations) {
  SurfacePose best;
  best.pose = start;
  Rigid3 pose = start;
  StepShare share;
  for (int i = 0;; ++i) {
    const std::vector<PointResidual> residuals = ComputeResiduals(points, pose, mesh);
    const double trimmed_rms_m = TrimmedRms(residuals);
    // The robust fit follows its weights; the coarse one can overshoot and keeps the best pose.
    if (i == 0 || is_fine || trimmed_rms_m < best.trimmed_rms_m) {
      best.pose = pose;
      best.trimmed_rms_m = trimmed_rms_m;
    }
    if (i == num_iterations || best.has_converged) return best;
    const bool is_robust = is_fine && EnoughOverSurface(residuals);
    const std::vector<double> weights = is_robust ? TukeyWeights(residuals, ZeroDistance_m(mesh))
                                                  : std::vector<double>(residuals.size(), 1.0);
    best.last_step_m = Step(residuals, weights, is_fine ? &share : nullptr, &pose);
    best.has_converged = best.last_step_m < kConverged * mesh.Diagonal_m();
  }
}

// The directions as a rotation.
Eigen::Matrix3d RightHanded(Eigen::Matrix3d directions) {
  if (directions.determinant() < 0) directions.col(0) *= -1;
  return directions;
}

std::vector<Rigid3> Starts(const Points& points, const MeshDistance& mesh, bool starts_as_is) {
  std::vector<Rigid3> starts = {Rigid3()};
  if (starts_as_is) return starts;
  const PrincipalAxes of_points = ComputePrincipalAxes(points);
  const PrincipalAxes of_mesh = AxesOfScatter(mesh.Moments().mean_m, mesh.Moments().covariance_m2);
  const Eigen::Matrix3d points_from_axes = RightHanded(of_points.directions);
  const Eigen::Matrix3d mesh_from_axes = RightHanded(of_mesh.directions);
  for (const Eigen::Matrix3d& turn : CubeRotations()) {
    const Eigen::Quaterniond rotation(
        Eigen::Matrix3d(mesh_from_axes * turn * points_from_axes.transpose()));
    starts.push_back({rotation, of_mesh.mean - rotation * of_points.mean});
  }
  return starts;
}

}  // namespace

double ZeroDistance_m(const MeshDistance& mesh) { return kFloor * mesh.Diagonal_m(); }

std::vector<PointResidual> ComputeResiduals(const Points& points, const Rigid3& pose,
                                            const MeshDistance& mesh) {
  std::vector<PointResidual> residuals;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d x = pose * point;
    const MeshFoot foot = mesh.Project(x);
    PointResidual residual{x, foot.normal, foot.distance_m, foot.IsOverSurface(mesh.Diagonal_m())};
    if (!residual.is_over_surface) {
      residual.distance_m = (x - foot.x_m).norm();
      residual.direction = (x - foot.x_m) / residual.distance_m;
    }
    residuals.push_back(residual);
  }
  return residuals;
}

bool EnoughOverSurface(const std::vector<PointResidual>& residuals) {
  const auto num = std::count_if(residuals.begin(), residuals.end(),
                                 [](const PointResidual& r) { return r.is_over_surface; });
  return num >= static_cast<long>(kMinPointsOverSurface);
}

std::vector<double> TukeyWeights(const std::vector<PointResidual>& residuals, double zero_m) {
  std::vector<double> distances_m;
  for (const PointResidual& r : residuals) {
    if (r.is_over_surface) distances_m.push_back(std::abs(r.distance_m));
  }
  const double cut_m = kTukey * std::max(kMadToSigma * Median(distances_m), zero_m);
  std::vector<double> weights;
  for (const PointResidual& r : residuals) {
    const double ratio = r.distance_m / cut_m;
    const double rest = std::max(0.0, 1 - ratio * ratio);
    weights.push_back(r.is_over_surface ? rest * rest : 0.0);
  }
  return weights;
}

std::vector<SurfacePose> FitToSurface(const Points& points, const MeshDistance& mesh,
                                      bool starts_as_is) {
  const auto better = [](const SurfacePose& a, const SurfacePose& b) {
    return a.trimmed_rms_m < b.trimmed_rms_m;
  };
  std::vector<SurfacePose> coarse;
  const Points thinned = Thinned(points, kMaxCoarsePoints);
  for (const Rigid3& start : Starts(points, mesh, starts_as_is)) {
    coarse.push_back(Iterate(thinned, mesh, start, false, kCoarseIterations));
  }
  std::stable_sort(coarse.begin(), coarse.end(), better);
  std::vector<SurfacePose> fits;
  for (std::size_t i = 0; i < std::min(coarse.size(), kNumFineStarts); ++i) {
    fits.push_back(Iterate(points, mesh, coarse[i].pose, true, kMaxFitIterations));
  }
  std::stable_sort(fits.begin(), fits.end(), better);
  return fits;
}

}  // namespace velamap
