#include "reconstruct/map_adjustment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <ceres/ceres.h>

#include "reconstruct/map_refinement.h"

namespace velamap {
namespace {

constexpr double kLossSigmas = 4.0;
constexpr double kScaleLossSigmas = 1.0;

Eigen::Matrix3d Cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

// d(q x)/dq for a unit quaternion in the order x y z w, from q x = x + 2 w (v x) + 2 v (v x).
Eigen::Matrix<double, 3, 4> RotatedFromQuaternion(const Eigen::Quaterniond& q,
                                                  const Eigen::Vector3d& x) {
  Eigen::Matrix<double, 3, 4> jacobian;
  const Eigen::Vector3d v = q.vec();
  jacobian.leftCols<3>() = -2 * (q.w() * Cross(x) + Cross(v.cross(x)) + Cross(v) * Cross(x));
  jacobian.col(3) = 2 * v.cross(x);
  return jacobian;
}

struct ScalePrior {
  template <typename T>
  bool operator()(const T* marker, T* residual) const {
    residual[0] = marker[7] / kScaleSigma;
    return true;
  }
};

using FrameParameters = std::array<double, 7>;
using MarkerParameters = std::array<double, 8>;

void Pack(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation, double* values) {
  Eigen::Vector4d::Map(values) = rotation.coeffs();
  Eigen::Vector3d::Map(values + 4) = translation;
}

Rigid3 Unpack(const double* values) {
  return {Eigen::Quaterniond(values).normalized(), Eigen::Vector3d::Map(values + 4)};
}

}  // namespace

bool MapReprojectionCost::Evaluate(double const* const* parameters, double* residuals,
                                   double** jacobians) const {
  const Eigen::Map<const Eigen::Quaterniond> cam_rotation(parameters[0]);
  const Eigen::Map<const Eigen::Vector3d> cam_translation(parameters[0] + 4);
  const Eigen::Map<const Eigen::Quaterniond> marker_rotation(parameters[1]);
  const Eigen::Map<const Eigen::Vector3d> marker_translation(parameters[1] + 4);
  const double scale = std::exp(parameters[1][7]);
  using FrameJacobian = Eigen::Matrix<double, 2 * kNumCorners, 7, Eigen::RowMajor>;
  using MarkerJacobian = Eigen::Matrix<double, 2 * kNumCorners, 8, Eigen::RowMajor>;
  const Eigen::Matrix3d rotation = cam_rotation.toRotationMatrix();
  for (int i = 0; i < kNumCorners; ++i) {
    const std::size_t corner_idx = static_cast<std::size_t>(i);
    const Eigen::Vector3d& x_in_marker = marker_.corners_in_marker[corner_idx];
    const Eigen::Vector3d from_center = scale * (marker_rotation * x_in_marker);
    const Eigen::Vector3d x_in_shape = from_center + marker_translation;
    const Eigen::Vector3d x = rotation * x_in_shape + cam_translation;
    if (!(x.z() > 0)) return false;
    const Eigen::Matrix2d px_from_ray =
        observation_.px_from_ray[corner_idx] / observation_.sigma_px;
    Eigen::Vector2d::Map(residuals + 2 * i) =
        px_from_ray * (x.hnormalized() - observation_.rays[corner_idx]);
    if (jacobians == nullptr) continue;
    Eigen::Matrix<double, 2, 3> ray_from_x;
    ray_from_x << 1 / x.z(), 0, -x.x() / (x.z() * x.z()), 0, 1 / x.z(), -x.y() / (x.z() * x.z());
    const Eigen::Matrix<double, 2, 3> px_from_x = px_from_ray * ray_from_x;
    if (jacobians[0] != nullptr) {
      Eigen::Map<FrameJacobian> jacobian(jacobians[0]);
      jacobian.middleRows<2>(2 * i).leftCols<4>() =
          px_from_x * RotatedFromQuaternion(cam_rotation, x_in_shape);
      jacobian.middleRows<2>(2 * i).rightCols<3>() = px_from_x;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<MarkerJacobian> jacobian(jacobians[1]);
      const Eigen::Matrix<double, 2, 3> px_from_shape = px_from_x * rotation;
      jacobian.middleRows<2>(2 * i).leftCols<4>() =
          scale * px_from_shape * RotatedFromQuaternion(marker_rotation, x_in_marker);
      jacobian.middleRows<2>(2 * i).middleCols<3>(4) = px_from_shape;
      jacobian.middleRows<2>(2 * i).col(7) = px_from_shape * from_center;
    }
  }
  return true;
}

void AdjustMap(const MapProblem& problem, const MapAdjustmentOptions& options,
               MapSolution* solution) {
  // In two arrays: Ceres orders parameters by their addresses, and so sums are always in one order.
  std::vector<FrameParameters> frames(problem.frames.size());
  std::vector<MarkerParameters> markers(problem.markers.size());
  std::vector<int> num_views_of_frame(problem.frames.size()), num_views(problem.markers.size());
  const auto takes_part = [&](std::size_t idx) {
    const MapObservation& observation = problem.observations[idx];
    return solution->fits[idx] &&
           solution->cam_from_shape[static_cast<std::size_t>(observation.frame_idx)] &&
           !solution->shape_from_marker[static_cast<std::size_t>(observation.marker_idx)].empty();
  };
  for (std::size_t idx = 0; idx < problem.observations.size(); ++idx) {
    if (takes_part(idx)) {
      ++num_views[static_cast<std::size_t>(problem.observations[idx].marker_idx)];
    }
  }
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::CauchyLoss loss(kLossSigmas * std::sqrt(2.0 * kNumCorners));
  ceres::CauchyLoss scale_loss(kScaleLossSigmas);
  ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>
      frame_manifold;
  ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<4>>
      marker_manifold;
  ceres::Problem ceres_problem(problem_options);
  const auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t idx = 0; idx < problem.observations.size(); ++idx) {
    const MapObservation& observation = problem.observations[idx];
    const std::size_t frame_idx = static_cast<std::size_t>(observation.frame_idx);
    const std::size_t marker_idx = static_cast<std::size_t>(observation.marker_idx);
    if (!takes_part(idx) || num_views[marker_idx] < 2) continue;
    double* const frame = frames[frame_idx].data();
    double* const marker = markers[marker_idx].data();
    if (num_views_of_frame[frame_idx]++ == 0) {
      const Rigid3& pose = *solution->cam_from_shape[frame_idx];
      Pack(pose.rotation, pose.translation, frame);
      ceres_problem.AddParameterBlock(frame, 7, &frame_manifold);
      ordering->AddElementToGroup(frame, 1);
    }
    if (!ceres_problem.HasParameterBlock(marker)) {
      const Sim3& place = solution->shape_from_marker[marker_idx].front();
      Pack(place.rotation, place.translation, marker);
      marker[7] = std::log(place.scale);
      ceres_problem.AddParameterBlock(marker, 8, &marker_manifold);
      ordering->AddElementToGroup(marker, 0);
      ceres_problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<ScalePrior, 1, 8>(new ScalePrior), &scale_loss, marker);
    }
    ceres_problem.AddResidualBlock(
        new MapReprojectionCost(observation, problem.Marker(observation.marker_idx)), &loss, frame,
        marker);
  }
  const auto first_frame = std::find_if(num_views_of_frame.begin(), num_views_of_frame.end(),
                                        [](int count) { return count > 0; });
  if (first_frame == num_views_of_frame.end()) return;
  ceres_problem.SetParameterBlockConstant(
      frames[static_cast<std::size_t>(first_frame - num_views_of_frame.begin())].data());
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering = ordering;
  solver.max_num_iterations = options.max_num_iterations;
  solver.function_tolerance = options.tolerance;
  solver.parameter_tolerance = 1e-14;
  solver.gradient_tolerance = 1e-14;
  solver.num_threads = 1;  // sums in the same order every time; starts run side by side instead
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &ceres_problem, &summary);
  if (!summary.IsSolutionUsable()) return;
  for (std::size_t idx = 0; idx < frames.size(); ++idx) {
    if (num_views_of_frame[idx] > 0) solution->cam_from_shape[idx] = Unpack(frames[idx].data());
  }
  for (std::size_t idx = 0; idx < markers.size(); ++idx) {
    if (!ceres_problem.HasParameterBlock(markers[idx].data())) continue;
    const Rigid3 rigid = Unpack(markers[idx].data());
    solution->shape_from_marker[idx].front() =
        Sim3{std::exp(markers[idx][7]), rigid.rotation, rigid.translation};
  }
}

}  // namespace velamap
