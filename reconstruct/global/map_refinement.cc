#include "reconstruct/global/map_refinement.h"

#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "importer/geometry/pose_step.h"

namespace velamap {
namespace {

// Cauchy loss: observations beyond this many sigmas lose weight.
constexpr double kLossSigmas = 4.0;

template <int N>
struct NormalEquations {
  // Sums of products of derivatives by the step and, in the column N, residuals.
  using Products = Eigen::Matrix<double, 8, 8, Eigen::RowMajor>;
  Products products = Products::Zero();
  double cost = 0.0;

  auto Hessian() const { return products.template topLeftCorner<N, N>(); }
  auto Gradient() const { return products.col(N).template head<N>(); }
};

// Adds one observation; `corner(i)` gives a corner in the cam frame, `by_step(i, by_x)` the
// derivative by the step of what has the derivative `by_x` by that corner.
template <int N, typename Corner, typename ByStep>
void AddObservation(const MapObservation& observation, const Corner& corner, const ByStep& by_step,
                    NormalEquations<N>* equations) {
  using Products = typename NormalEquations<N>::Products;
  static_assert(N < Products::ColsAtCompileTime && 2 * kNumCorners == Products::RowsAtCompileTime);
  Products rows = Products::Zero(), products = Products::Zero();
  for (int i = 0; i < kNumCorners; ++i) {
    const std::size_t corner_idx = static_cast<std::size_t>(i);
    const Eigen::Vector3d x = corner(corner_idx);
    if (!(x.z() > 0)) {
      equations->cost = std::numeric_limits<double>::infinity();
      return;
    }
    const Eigen::Matrix2d scaled = observation.px_from_ray[corner_idx] / observation.sigma_px;
    rows.template block<2, N>(2 * i, 0) = by_step(corner_idx, scaled * RayFromPoint(x));
    rows.template block<2, 1>(2 * i, N) = scaled * (x.hnormalized() - observation.rays[corner_idx]);
  }
  products.noalias() += rows.transpose() * rows;
  constexpr double kScale = kLossSigmas * kLossSigmas * 2 * kNumCorners;
  const double squared = products(N, N);
  equations->cost += 0.5 * kScale * std::log1p(squared / kScale);
  equations->products += products / (1 + squared / kScale);
}

// `equations_at(estimate)` linearises, `plus(estimate, step)` moves.
template <int N, typename Estimate, typename EquationsAt, typename Plus>
Estimate Minimise(Estimate estimate, const EquationsAt& equations_at, const Plus& plus) {
  constexpr int kMaxIterations = 20;
  constexpr double kMinStep = 1e-13, kMinDecrease = 1e-7;
  NormalEquations<N> equations = equations_at(estimate);
  double damping = 1e-4;
  for (int i = 0; i < kMaxIterations && std::isfinite(equations.cost); ++i) {
    Eigen::Matrix<double, N, N> damped = equations.Hessian();
    damped.diagonal() *= 1 + damping;
    const Eigen::Matrix<double, N, 1> step = -damped.ldlt().solve(equations.Gradient());
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
      std::array<Eigen::Vector3d, kNumCorners> rotated;
      for (std::size_t i = 0; i < kNumCorners; ++i) rotated[i] = rotation * corners[i];
      AddObservation(
          *placed.observation,
          [&](std::size_t i) { return Eigen::Vector3d(rotated[i] + pose.translation); },
          [&](std::size_t i, const Eigen::Matrix<double, 2, 3>& by_x) {
            Eigen::Matrix<double, 2, 6> by_step;
            by_step << ByTurn(by_x, rotated[i]), by_x;
            return by_step;
          },
          &equations);
    }
    return equations;
  };
  return Minimise<6>(cam_from_shape, equations_at, Moved);
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
      std::array<Eigen::Vector3d, kNumCorners> rotated;
      for (std::size_t i = 0; i < kNumCorners; ++i) rotated[i] = rotation * corners[i];
      AddObservation(
          observation,
          [&](std::size_t i) {
            return Eigen::Vector3d(cam_rotation * (rotated[i] + place.translation) +
                                   pose.translation);
          },
          [&](std::size_t i, const Eigen::Matrix<double, 2, 3>& by_x) {
            const Eigen::Matrix<double, 2, 3> by_x_in_shape = by_x * cam_rotation;
            Eigen::Matrix<double, 2, 7> by_step;
            by_step << ByTurn(by_x_in_shape, rotated[i]), by_x_in_shape, by_x_in_shape * rotated[i];
            return by_step;
          },
          &equations);
    }
    const double log_scale = std::log(place.scale);
    equations.cost += 0.5 * std::pow(log_scale / kScaleSigma, 2);
    equations.products(6, 6) += 1 / (kScaleSigma * kScaleSigma);
    equations.products(6, 7) += log_scale / (kScaleSigma * kScaleSigma);
    return equations;
  };
  const auto plus = [](const Sim3& place, const Eigen::Matrix<double, 7, 1>& step) {
    return Sim3{place.scale * std::exp(step[6]), Turned(step.head<3>(), place.rotation),
                place.translation + step.segment<3>(3)};
  };
  return Minimise<7>(shape_from_marker, equations_at, plus);
}

}  // namespace velamap
