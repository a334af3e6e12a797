#include "reconstruct/global/map_adjustment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <vector>

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/product_manifold.h>

#include "importer/geometry/pose_step.h"
#include "reconstruct/global/map_refinement.h"
#include "reconstruct/solve/schur_solver.h"

namespace velamap {
namespace {

constexpr double kLossSigmas = 4.0;
constexpr double kScaleLossSigmas = 1.0;

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

// The map as a least-squares problem; its blocks are the frames, then the markers.
class AdjustableMap {
 public:
  AdjustableMap(const MapProblem& map, const MapSolution& solution)
      : frames_(map.frames.size()), markers_(map.markers.size()) {
    for (FrameParameters& frame : frames_) problem_.blocks.push_back({frame.data(), 7});
    for (MarkerParameters& marker : markers_) problem_.blocks.push_back({marker.data(), 8});
    std::vector<const MapObservation*> observations;
    std::vector<int> num_views(map.markers.size());
    for (std::size_t idx = 0; idx < map.observations.size(); ++idx) {
      const MapObservation& observation = map.observations[idx];
      const std::size_t marker_idx = static_cast<std::size_t>(observation.marker_idx);
      if (!solution.fits[idx] ||
          !solution.cam_from_shape[static_cast<std::size_t>(observation.frame_idx)] ||
          solution.shape_from_marker[marker_idx].empty()) {
        continue;
      }
      observations.push_back(&observation);
      ++num_views[marker_idx];
    }
    for (const MapObservation* observation : observations) {
      const std::size_t frame_idx = static_cast<std::size_t>(observation->frame_idx);
      const std::size_t marker_idx = static_cast<std::size_t>(observation->marker_idx);
      if (num_views[marker_idx] < 2) continue;
      AddFrame(frame_idx, *solution.cam_from_shape[frame_idx]);
      AddMarker(marker_idx, solution.shape_from_marker[marker_idx].front());
      errors_.emplace_back(*observation, map.Marker(observation->marker_idx));
      problem_.residuals.push_back(
          {&errors_.back(),
           &loss_,
           {observation->frame_idx, static_cast<int>(frames_.size() + marker_idx)}});
    }
  }

  // False where there is none.
  bool HoldFirstFrame() {
    const auto end = problem_.blocks.begin() + static_cast<std::ptrdiff_t>(frames_.size());
    const auto first = std::find_if(problem_.blocks.begin(), end, IsUsed);
    if (first == end) return false;
    first->kind = SchurBlock::Kind::kConstant;
    return true;
  }

  const SchurProblem& Problem() const { return problem_; }

  void WriteTo(MapSolution* solution) const {
    for (std::size_t idx = 0; idx < frames_.size(); ++idx) {
      if (IsUsed(problem_.blocks[idx])) {
        solution->cam_from_shape[idx] = Unpack(frames_[idx].data());
      }
    }
    for (std::size_t idx = 0; idx < markers_.size(); ++idx) {
      if (!IsUsed(problem_.blocks[frames_.size() + idx])) continue;
      const Rigid3 rigid = Unpack(markers_[idx].data());
      solution->shape_from_marker[idx].front() =
          Sim3{std::exp(markers_[idx][7]), rigid.rotation, rigid.translation};
    }
  }

 private:
  static bool IsUsed(const SchurBlock& block) { return block.kind != SchurBlock::Kind::kConstant; }

  void AddFrame(std::size_t idx, const Rigid3& pose) {
    SchurBlock& block = problem_.blocks[idx];
    if (IsUsed(block)) return;
    block.kind = SchurBlock::Kind::kKept;
    block.manifold = &frame_manifold_;
    Pack(pose.rotation, pose.translation, block.values);
  }

  void AddMarker(std::size_t idx, const Sim3& place) {
    SchurBlock& block = problem_.blocks[frames_.size() + idx];
    if (IsUsed(block)) return;
    block.kind = SchurBlock::Kind::kEliminated;
    block.manifold = &marker_manifold_;
    Pack(place.rotation, place.translation, block.values);
    block.values[7] = std::log(place.scale);
    problem_.residuals.push_back(
        {&scale_prior_, &scale_loss_, {static_cast<int>(frames_.size() + idx)}});
  }

  std::vector<FrameParameters> frames_;
  std::vector<MarkerParameters> markers_;
  std::deque<MapReprojectionCost> errors_;
  const ceres::AutoDiffCostFunction<ScalePrior, 1, 8> scale_prior_{new ScalePrior};
  const ceres::CauchyLoss loss_{kLossSigmas * std::sqrt(2.0 * kNumCorners)};
  const ceres::CauchyLoss scale_loss_{kScaleLossSigmas};
  const ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>
      frame_manifold_;
  const ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<4>>
      marker_manifold_;
  SchurProblem problem_;
};

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
    const Eigen::Matrix<double, 2, 3> px_from_x = px_from_ray * RayByPoint(x);
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
  AdjustableMap map(problem, *solution);
  if (!map.HoldFirstFrame()) return;
  SchurSolverOptions solver;
  solver.max_num_iterations = options.max_num_iterations;
  solver.function_tolerance = options.tolerance;
  solver.gradient_tolerance = 1e-14;
  if (SolveSchur(solver, map.Problem()).is_usable) map.WriteTo(solution);
}

}  // namespace velamap
