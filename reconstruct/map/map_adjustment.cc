#include "reconstruct/map/map_adjustment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <iterator>
#include <optional>
#include <vector>

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/product_manifold.h>

#include "importer/geometry/pose_step.h"
#include "reconstruct/map/map_refinement.h"
#include "reconstruct/solve/schur_complement.h"

namespace velamap {
namespace {

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

// The map as a least-squares problem.
class AdjustableMap {
 public:
  AdjustableMap(const MapProblem& map, const MapSolution& solution)
      : problem_(KeepOwnership()), frames_(map.frames.size()), markers_(map.markers.size()) {
    std::vector<const MapObservation*> observations;
    std::vector<int> num_views(map.markers.size());
    for (std::size_t idx = 0; idx < map.observations.size(); ++idx) {
      const MapObservation& observation = map.observations[idx];
      const std::size_t marker_idx = static_cast<std::size_t>(observation.marker_idx);
      if (!solution.is_inlier[idx] || !solution.Pose(observation.frame_idx) ||
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
      problem_.AddResidualBlock(&errors_.back(), &loss_, frames_[frame_idx]->data(),
                                markers_[marker_idx]->data());
    }
  }

  // Minimizes with the first frame that takes part held fixed. Returns false if no frame takes part
  // or no step can be computed.
  bool Minimize(const SchurOptions& options) {
    const auto first =
        std::find_if(frames_.begin(), frames_.end(), [](const auto& f) { return f.has_value(); });
    if (first == frames_.end()) return false;
    problem_.SetParameterBlockConstant((*first)->data());
    std::vector<double*> markers, frames;
    for (auto& marker : markers_) {
      if (marker) markers.push_back(marker->data());
    }
    for (auto frame = std::next(first); frame != frames_.end(); ++frame) {
      if (*frame) frames.push_back((*frame)->data());
    }
    return MinimizeBySchurComplement(options, markers, frames, &problem_).is_usable;
  }

  void WriteTo(MapSolution* solution) const {
    for (std::size_t idx = 0; idx < frames_.size(); ++idx) {
      if (frames_[idx]) solution->cam_from_shape[idx] = Unpack(frames_[idx]->data());
    }
    for (std::size_t idx = 0; idx < markers_.size(); ++idx) {
      if (!markers_[idx]) continue;
      const Rigid3 rigid = Unpack(markers_[idx]->data());
      solution->shape_from_marker[idx].front() =
          Sim3{std::exp((*markers_[idx])[7]), rigid.rotation, rigid.translation};
    }
  }

 private:
  // Cost functions, losses and manifolds are members.
  static ceres::Problem::Options KeepOwnership() {
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  void AddFrame(std::size_t idx, const Rigid3& pose) {
    if (frames_[idx]) return;
    double* values = frames_[idx].emplace().data();
    Pack(pose.rotation, pose.translation, values);
    problem_.AddParameterBlock(values, 7, &frame_manifold_);
  }

  void AddMarker(std::size_t idx, const Sim3& place) {
    if (markers_[idx]) return;
    double* values = markers_[idx].emplace().data();
    Pack(place.rotation, place.translation, values);
    values[7] = std::log(place.scale);
    problem_.AddParameterBlock(values, 8, &marker_manifold_);
    problem_.AddResidualBlock(&scale_prior_, &scale_loss_, values);
  }

  ceres::AutoDiffCostFunction<ScalePrior, 1, 8> scale_prior_{new ScalePrior};
  ceres::CauchyLoss loss_{kLossSigmas * std::sqrt(2.0 * kNumCorners)};
  ceres::CauchyLoss scale_loss_{kScaleLossSigmas};
  ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>
      frame_manifold_;
  ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<4>>
      marker_manifold_;
  std::deque<MapReprojectionCost> errors_;
  ceres::Problem problem_;
  std::vector<std::optional<FrameParameters>> frames_;  // those that take part
  std::vector<std::optional<MarkerParameters>> markers_;
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
  SchurOptions schur;
  schur.max_num_iterations = options.max_num_iterations;
  schur.function_tolerance = options.tolerance;
  if (map.Minimize(schur)) map.WriteTo(solution);
}

}  // namespace velamap
