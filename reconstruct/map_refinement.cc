#include "reconstruct/map_refinement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace velamap {
namespace {

// Cauchy loss: observations beyond this many sigmas lose weight.
constexpr double kLossSigmas = 4.0;

template <int N>
struct NormalEquations {
  Eigen::Matrix<double, N, N> hessian = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> gradient = Eigen::Matrix<double, N, 1>::Zero();
  double cost = 0.0;
};

Eigen::Matrix3d Cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

// Adds one observation; `corner(i, x_in_cam, jacobian)` gives a corner and its derivative by the
// step.
template <int N, typename Corner>
void AddObservation(const MapObservation& observation, const Corner& corner,
                    NormalEquations<N>* equations) {
  Eigen::Matrix<double, 2 * kNumCorners, N> jacobian;
  Eigen::Matrix<double, 2 * kNumCorners, 1> residuals;
  for (int i = 0; i < kNumCorners; ++i) {
    const std::size_t corner_idx = static_cast<std::size_t>(i);
    Eigen::Vector3d x;
    Eigen::Matrix<double, 3, N> x_from_step;
    corner(corner_idx, &x, &x_from_step);
    if (!(x.z() > 0)) {
      equations->cost = std::numeric_limits<double>::infinity();
      return;
    }
    Eigen::Matrix<double, 2, 3> ray_from_x;
    ray_from_x << 1 / x.z(), 0, -x.x() / (x.z() * x.z()), 0, 1 / x.z(), -x.y() / (x.z() * x.z());
    const Eigen::Matrix2d scaled = observation.px_from_ray[corner_idx] / observation.sigma_px;
    residuals.template segment<2>(2 * i) =
        scaled * (x.hnormalized() - observation.rays[corner_idx]);
    jacobian.template middleRows<2>(2 * i) = scaled * ray_from_x * x_from_step;
  }
  constexpr double kScale = kLossSigmas * kLossSigmas * 2 * kNumCorners;
  const double squared = residuals.squaredNorm();
  const double weight = 1 / (1 + squared / kScale);
  equations->cost += 0.5 * kScale * std::log1p(squared / kScale);
  // Small and fixed: Eigen's kernels for large products would only cost time.
  equations->hessian += weight * jacobian.transpose().lazyProduct(jacobian);
  equations->gradient += weight * jacobian.transpose().lazyProduct(residuals);
}

// `equations_at(estimate)` linearises, `plus(estimate, step)` moves.
template <int N, typename Estimate, typename EquationsAt, typename Plus>
Estimate Minimise(Estimate estimate, const EquationsAt& equations_at, const Plus& plus) {
  constexpr int kMaxIterations = 20;
  constexpr double kMinStep = 1e-13, kMinDecrease = 1e-7;
  NormalEquations<N> equations = equations_at(estimate);
  double damping = 1e-4;
  for (int i = 0; i < kMaxIterations && std::isfinite(equations.cost); ++i) {
    Eigen::Matrix<double, N, N> damped = equations.hessian;
    damped.diagonal() *= 1 + damping;
    const Eigen::Matrix<double, N, 1> step = -damped.ldlt().solve(equations.gradient);
    if (!step.allFinite() || step.norm() < kMinStep) break;
    const Estimate candidate = plus(estimate, step);
    const NormalEquations<N> at_candidate = equations_at(candidate);
    if (at_candidate.cost < equations.cost) {
      const bool converged = equations.cost - at_candidate.cost < kMinDecrease * equations.cost;
      estimate = candidate;
      equations = at_candidate;
      damping *= 0.1;
      if (converged) break;
    } else {
      damping *= 10;
      if (damping > 1e6) break;
    }
  }
  return estimate;
}

Eigen::Quaterniond Turned(const Eigen::Vector3d& turn, const Eigen::Quaterniond& rotation) {
  const double angle = turn.norm();
  if (!(angle > 0)) return rotation;
  return (Eigen::AngleAxisd(angle, turn / angle) * rotation).normalized();
}

}  // namespace

Rigid3 RefineFramePose(const MapProblem& problem,
                       const std::vector<PlacedObservation>& observations,
                       const Rigid3& cam_from_shape) {
  const auto equations_at = [&](const Rigid3& pose) {
    NormalEquations<6> equations;
    const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
    for (const PlacedObservation& placed : observations) {
      const auto corners =
          CornersInShape(problem.Marker(placed.observation->marker_idx), *placed.shape_from_marker);
      AddObservation<6>(
          *placed.observation,
          [&](std::size_t i, Eigen::Vector3d* x, Eigen::Matrix<double, 3, 6>* jacobian) {
            const Eigen::Vector3d rotated = rotation * corners[i];
            *x = rotated + pose.translation;
            *jacobian << -Cross(rotated), Eigen::Matrix3d::Identity();
          },
          &equations);
    }
    return equations;
  };
  const auto plus = [](const Rigid3& pose, const Eigen::Matrix<double, 6, 1>& step) {
    return Rigid3{Turned(step.head<3>(), pose.rotation), pose.translation + step.tail<3>()};
  };
  return Minimise<6>(cam_from_shape, equations_at, plus);
}

Sim3 RefineMarkerPlace(const MapProblem& problem, const MapSolution& solution,
                       const std::vector<int>& observation_idxs, const Sim3& shape_from_marker) {
  const auto equations_at = [&](const Sim3& place) {
    NormalEquations<7> equations;
    const Eigen::Matrix3d rotation = place.scale * place.rotation.toRotationMatrix();
    for (const int idx : observation_idxs) {
      const MapObservation& observation = problem.Observation(idx);
      const Rigid3& pose =
          *solution.cam_from_shape[static_cast<std::size_t>(observation.frame_idx)];
      const Eigen::Matrix3d cam_rotation = pose.rotation.toRotationMatrix();
      const auto& corners = problem.Marker(observation.marker_idx).corners_in_marker;
      AddObservation<7>(
          observation,
          [&](std::size_t i, Eigen::Vector3d* x, Eigen::Matrix<double, 3, 7>* jacobian) {
            const Eigen::Vector3d rotated = rotation * corners[i];
            *x = cam_rotation * (rotated + place.translation) + pose.translation;
            *jacobian << -cam_rotation * Cross(rotated), cam_rotation, cam_rotation * rotated;
          },
          &equations);
    }
    const double log_scale = std::log(place.scale);
    equations.cost += 0.5 * std::pow(log_scale / kScaleSigma, 2);
    equations.hessian(6, 6) += 1 / (kScaleSigma * kScaleSigma);
    equations.gradient[6] += log_scale / (kScaleSigma * kScaleSigma);
    return equations;
  };
  const auto plus = [](const Sim3& place, const Eigen::Matrix<double, 7, 1>& step) {
    return Sim3{place.scale * std::exp(step[6]), Turned(step.head<3>(), place.rotation),
                place.translation + step.segment<3>(3)};
  };
  return Minimise<7>(shape_from_marker, equations_at, plus);
}

}  // namespace velamap
