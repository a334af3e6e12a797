#include "reconstruct/map/map_refinement.h"

#include <array>
#include <cmath>

#include "importer/geometry/least_squares.h"
#include "importer/geometry/pose_step.h"

namespace velamap {
namespace {

constexpr CauchyLoss kLoss{kLossSigmas * kLossSigmas * 2 * kNumCorners};

LeastSquaresOptions Options() {
  LeastSquaresOptions options;
  options.min_step = 1e-13;
  options.min_relative_decrease = 1e-7;
  return options;
}

// Adds the whitened residuals of an observation's corners. `corner(i)` returns corner i in the cam
// frame; `by_step(i, by_x)` turns `by_x`, the derivative with respect to that point, into the one
// with respect to a step.
template <int N, typename Corner, typename ByStep>
void AddObservation(const MapObservation& observation, const Corner& corner, const ByStep& by_step,
                    GaussNewtonEquations<N>* equations) {
  Eigen::Matrix<double, 2 * kNumCorners, N> jacobian;
  Eigen::Matrix<double, 2 * kNumCorners, 1> residual;
  for (int i = 0; i < kNumCorners; ++i) {
    const std::size_t corner_idx = static_cast<std::size_t>(i);
    const Eigen::Vector3d x = corner(corner_idx);
    if (!(x.z() > 0)) return equations->Reject();
    const Eigen::Matrix2d whitening = observation.px_from_ray[corner_idx] / observation.sigma_px;
    jacobian.template middleRows<2>(2 * i) = by_step(corner_idx, whitening * RayByPoint(x));
    residual.template segment<2>(2 * i) =
        whitening * (x.hnormalized() - observation.rays[corner_idx]);
  }
  equations->Add(jacobian, residual, kLoss);
}

std::array<Eigen::Vector3d, kNumCorners> Rotated(
    const Eigen::Matrix3d& rotation, const std::array<Eigen::Vector3d, kNumCorners>& corners) {
  std::array<Eigen::Vector3d, kNumCorners> rotated;
  for (std::size_t i = 0; i < kNumCorners; ++i) rotated[i] = rotation * corners[i];
  return rotated;
}

}  // namespace

void FramePoseProblem::Evaluate(const Rigid3& cam_from_shape, bool, Equations* equations) const {
  *equations = {};
  const Eigen::Matrix3d rotation = cam_from_shape.rotation.toRotationMatrix();
  for (const PlacedObservation& placed : observations) {
    const auto rotated = Rotated(
        rotation,
        CornersInShape(problem.Marker(placed.observation->marker_idx), *placed.shape_from_marker));
    AddObservation(
        *placed.observation,
        [&](std::size_t i) { return Eigen::Vector3d(rotated[i] + cam_from_shape.translation); },
        [&](std::size_t i, const Eigen::Matrix<double, 2, 3>& by_x) {
          return ByPoseStep(by_x, rotated[i]);
        },
        equations);
  }
}

Rigid3 FramePoseProblem::Plus(const Rigid3& pose, const Step& step) const {
  return PlusPose(pose, step);
}

void MarkerPlaceProblem::Evaluate(const Sim3& place, bool, Equations* equations) const {
  *equations = {};
  const Eigen::Matrix3d scaled_rotation = place.scale * place.rotation.toRotationMatrix();
  for (const int idx : observation_idxs) {
    const MapObservation& observation = problem.Observation(idx);
    const Rigid3& cam_from_shape = *solution.Pose(observation.frame_idx);
    const Eigen::Matrix3d cam_rotation = cam_from_shape.rotation.toRotationMatrix();
    const auto rotated =
        Rotated(scaled_rotation, problem.Marker(observation.marker_idx).corners_in_marker);
    AddObservation(
        observation,
        [&](std::size_t i) {
          return Eigen::Vector3d(cam_rotation * (rotated[i] + place.translation) +
                                 cam_from_shape.translation);
        },
        [&](std::size_t i, const Eigen::Matrix<double, 2, 3>& by_x) {
          const Eigen::Matrix<double, 2, 3> by_x_in_shape = by_x * cam_rotation;
          Eigen::Matrix<double, 2, 7> by_step;
          by_step << ByPoseStep(by_x_in_shape, rotated[i]), by_x_in_shape * rotated[i];
          return by_step;
        },
        equations);
  }
  const Eigen::Matrix<double, 1, 7> by_step = Eigen::Matrix<double, 1, 7>::Unit(6) / kScaleSigma;
  equations->Add(by_step, Eigen::Matrix<double, 1, 1>(std::log(place.scale) / kScaleSigma));
}

Sim3 MarkerPlaceProblem::Plus(const Sim3& place, const Step& step) const {
  return {place.scale * std::exp(step[6]), PlusRotation(place.rotation, step.head<3>()),
          place.translation + step.segment<3>(3)};
}

Rigid3 RefineFramePose(const MapProblem& problem,
                       const std::vector<PlacedObservation>& observations,
                       const Rigid3& cam_from_shape) {
  Rigid3 refined = cam_from_shape;
  FramePoseProblem::Equations equations;
  MinimizeSquares(Options(), FramePoseProblem(problem, observations), &refined, &equations);
  return refined;
}

Sim3 RefineMarkerPlace(const MapProblem& problem, const MapSolution& solution,
                       const std::vector<int>& observation_idxs, const Sim3& shape_from_marker) {
  Sim3 refined = shape_from_marker;
  MarkerPlaceProblem::Equations equations;
  MinimizeSquares(Options(), MarkerPlaceProblem(problem, solution, observation_idxs), &refined,
                  &equations);
  return refined;
}

}  // namespace velamap
