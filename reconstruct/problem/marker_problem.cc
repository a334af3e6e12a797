#include "reconstruct/problem/marker_problem.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include <ceres/manifold.h>
#include <ceres/product_manifold.h>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "importer/camera/camera_projection.h"
#include "reconstruct/geometry/intrinsics_prior.h"
#include "reconstruct/problem/marker_cost_functions.h"
#include "reconstruct/problem/prior_cost_functions.h"
#include "reconstruct/problem/scale_bar.h"
#include "reconstruct/solve/schur_complement.h"

namespace velamap {
namespace {

// Prior of the readout time of a camera, from the first row of an image to the last.
constexpr double kRollingShutterSigma_s = 0.03;

int SlotOf(const MarkerBlock& marker, int corner) {
  const auto it = std::find(marker.corners.begin(), marker.corners.end(), corner);
  return it == marker.corners.end() ? -1 : static_cast<int>(it - marker.corners.begin());
}

// Sum of the unit vectors along both sides away from the corner, in the image.
Eigen::Vector2d InsetDirection(const Camera& camera, const Rigid3& cam_from_world,
                               const MarkerBlock& marker, int slot_of_corner) {
  const int corner = marker.corners[static_cast<std::size_t>(slot_of_corner)];
  const auto project = [&](int other) -> std::optional<Eigen::Vector2d> {
    const int slot = SlotOf(marker, other);
    if (slot < 0) return std::nullopt;
    return ImageFromCam(camera, cam_from_world * CornerPosition(marker, slot));
  };
  const auto here = project(corner);
  const auto next = project(corner % kNumCorners + 1);
  const auto previous = project((corner + kNumCorners - 2) % kNumCorners + 1);
  if (!here || !next || !previous) return Eigen::Vector2d::Zero();
  return (*next - *here).normalized() + (*previous - *here).normalized();
}

// Null if nothing is known of the image.
template <typename Values>
const Values* Find(const std::map<ImageId, Values>& of_image, ImageId image_id) {
  const auto found = of_image.find(image_id);
  return found == of_image.end() ? nullptr : &found->second;
}

// `of_image` may be null.
double CornerSigma(const MarkerAdjustmentOptions& options, const std::vector<double>* of_image,
                   std::size_t point2D_idx) {
  const double known_px =
      of_image != nullptr && point2D_idx < of_image->size() ? (*of_image)[point2D_idx] : 0.0;
  return std::hypot(known_px > 0 ? known_px : options.corner_sigma_px,
                    options.corner_sigma_floor_px);
}

class ProblemBuilder {
 public:
  ProblemBuilder(const MarkerAdjustmentOptions& options, const Model& model,
                 const MarkerWeights& weights, MarkerState* state)
      : options_(options), model_(model), weights_(weights), state_(*state) {}

  void AddParameters(const std::map<CameraId, Camera>& calibration) {
    for (MarkerBlock& marker : state_.markers) {
      result_.ceres->AddParameterBlock(marker.x_in_world.data(), marker.NumCoordinates());
      result_.marker_blocks.push_back(marker.x_in_world.data());
    }
    auto* pose_manifold = new PoseManifold;  // of all images; the problem owns it
    for (ImageBlock& image : state_.images) {
      AddGlobal(image.cam_from_world.data(), 7, &image != &state_.images.front(), pose_manifold);
    }
    for (auto& [camera_id, intrinsics] : state_.intrinsics) {
      const IntrinsicsPrior prior = PriorOf(calibration.at(camera_id));
      const int size = static_cast<int>(intrinsics.size());
      ceres::Manifold* manifold = prior.held.empty() || prior.free.empty()
                                      ? nullptr
                                      : new ceres::SubsetManifold(size, prior.held);
      AddGlobal(intrinsics.data(), size, !prior.free.empty(), manifold);
    }
    if (!weights_.frees_rolling_shutter) state_.rolling_shutter_s = options_.rolling_shutter_s;
    AddGlobal(&state_.rolling_shutter_s, 1, weights_.frees_rolling_shutter);
    AddGlobal(&state_.inset_px, 1, EstimatesInset());
    AddGlobal(&state_.print_scale, 1, print_scale_sigma_ > 0 && !weights_.holds_print_scale);
    for (auto& [part, scale] : state_.part_scales) {
      AddGlobal(&scale, 1, weights_.part_scale_sigma > 0);
    }
  }

  void AddCorners(const CornerErrors& corner_errors) {
    result_.corner_correlation = weights_.corner_correlation;
    std::unordered_map<ImageId, std::size_t> image_idxs;
    std::vector<const std::vector<double>*> sigmas;
    std::vector<const std::vector<CornerMotion>*> motions;
    for (const ImageBlock& image : state_.images) {
      image_idxs[image.image_id] = sigmas.size();
      sigmas.push_back(Find(corner_errors.sigmas_px, image.image_id));
      motions.push_back(Find(corner_errors.motions, image.image_id));
    }
    std::vector<std::vector<SeenCorner>> views(state_.images.size());  // of one marker, by image
    for (MarkerBlock& marker : state_.markers) {
      for (int slot = 0; slot < static_cast<int>(marker.corners.size()); ++slot) {
        const int corner = marker.corners[static_cast<std::size_t>(slot)];
        const Point3DId point3D_id = Point3DIdFromCorner({marker.marker_id, corner});
        for (const TrackElement& element : model_.points3D.at(point3D_id).track) {
          views[image_idxs.at(element.image_id)].push_back({slot, point3D_id, element});
        }
      }
      for (std::size_t image_idx = 0; image_idx < views.size(); ++image_idx) {
        if (views[image_idx].empty()) continue;
        AddView(image_idx, views[image_idx], sigmas[image_idx], motions[image_idx], &marker);
        views[image_idx].clear();
      }
    }
  }

  void AddPriors(const std::map<CameraId, Camera>& calibration) {
    for (MarkerBlock& marker : state_.markers) {
      const bool has_size = weights_.markers_without_size.count(marker.marker_id) == 0;
      // The corners of a marker that is bent along a diagonal are not in one plane.
      const double flatness = !marker.chords.IsFlat() ? 0.0
                              : marker.is_rigid       ? options_.rigid_flatness
                                                      : options_.cloth_flatness;
      const double side_sigma_m =
          std::hypot(weights_.print_tolerance * marker.length_m, options_.print_resolution_m);
      const MarkerPrior prior{marker.length_m, has_size ? side_sigma_m : 0.0,
                              std::sqrt(2.0) * side_sigma_m, flatness * marker.length_m,
                              marker.chords};
      auto error = std::make_unique<MarkerPriorError>(prior, marker.corners);
      if (error->num_residuals() == 0) continue;
      AddPrior(std::move(error), {marker.x_in_world.data(), &state_.print_scale,
                                  &state_.part_scales.at(marker.part)});
    }
    if (EstimatesInset()) AddPriorAroundZero(options_.inset_sigma_px, &state_.inset_px);
    if (print_scale_sigma_ > 0) AddPriorAroundZero(print_scale_sigma_, &state_.print_scale);
    for (auto& [part, scale] : state_.part_scales) {
      if (weights_.part_scale_sigma > 0) AddPriorAroundZero(weights_.part_scale_sigma, &scale);
    }
    if (weights_.frees_rolling_shutter) {
      AddPriorAroundZero(kRollingShutterSigma_s, &state_.rolling_shutter_s);
    }
    for (auto& [camera_id, intrinsics] : state_.intrinsics) {
      const IntrinsicsPrior prior = PriorOf(calibration.at(camera_id));
      if (!prior.free.empty()) {
        AddPrior(std::make_unique<ParameterPriorError>(prior.mean, prior.sigmas),
                 {intrinsics.data()});
      }
      if (options_.find_camera && !HasOneFocalLength(prior.model)) {
        AddPrior(std::make_unique<PixelShapeError>(static_cast<int>(intrinsics.size()),
                                                   kPixelShapeSigma),
                 {intrinsics.data()});
      }
    }
  }

  void AddScaleBars() {
    for (const ScaleBar& bar : FindScaleBars(state_, weights_.scale_bars)) {
      std::vector<double*> blocks;
      for (const int idx : bar.marker_idxs) blocks.push_back(result_.marker_blocks[idx]);
      if (blocks.size() > 1 && result_.kept_markers.count(blocks[0]) == 0) {
        result_.kept_markers.insert(blocks[1]);
      }
      AddResidual(std::make_unique<ScaleBarError>(bar.distance.length_m, bar.distance.sigma_m,
                                                  bar.corner_weights),
                  blocks);
    }
  }

  MarkerProblem Take() { return std::move(result_); }

 private:
  struct SeenCorner {
    int slot;
    Point3DId point3D_id;
    TrackElement element;
  };
  using PoseManifold =
      ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>;

  // The problem takes the manifold.
  void AddGlobal(double* values, int size, bool varies, ceres::Manifold* manifold = nullptr) {
    result_.ceres->AddParameterBlock(values, size, manifold);
    if (varies) {
      result_.global_blocks.push_back(values);
    } else {
      result_.ceres->SetParameterBlockConstant(values);
    }
  }

  ceres::ResidualBlockId AddResidual(std::unique_ptr<ceres::CostFunction> error,
                                     const std::vector<double*>& blocks) {
    return result_.ceres->AddResidualBlock(error.release(), nullptr, blocks);
  }

  void AddPrior(std::unique_ptr<ceres::CostFunction> error, const std::vector<double*>& blocks) {
    result_.prior_residuals.push_back(AddResidual(std::move(error), blocks));
  }

  void AddPriorAroundZero(double sigma, double* value) {
    AddPrior(std::make_unique<ParameterPriorError>(std::vector{0.0}, std::vector{sigma}), {value});
  }

  void AddView(std::size_t image_idx, const std::vector<SeenCorner>& view,
               const std::vector<double>* sigmas_px, const std::vector<CornerMotion>* motions,
               MarkerBlock* marker) {
    ImageBlock& block = state_.images[image_idx];
    const ModelImage& image = model_.images[image_idx];
    const Camera& camera = model_.cameras.at(image.camera_id);
    std::vector<CornerObservation> observations(view.size());
    const auto found_factor = weights_.marker_factors.find(marker->marker_id);
    const double marker_factor =
        found_factor == weights_.marker_factors.end() ? 1.0 : found_factor->second;
    for (std::size_t i = 0; i < view.size(); ++i) {
      const auto& [slot, point3D_id, element] = view[i];
      CornerObservation& observation = observations[i];
      observation.slot = slot;
      observation.x_in_image_px = image.points2D.at(element.point2D_idx).x_in_image_px;
      observation.sigma_px = marker_factor * weights_.corner_factor *
                             CornerSigma(options_, sigmas_px, element.point2D_idx);
      if (EstimatesInset()) {
        observation.inset_direction = InsetDirection(camera, image.cam_from_world, *marker, slot);
      }
      if (motions != nullptr) {
        observation.motion =
            RowMotionOf(camera, observation.x_in_image_px, motions->at(element.point2D_idx));
        observation.sigma_px = std::hypot(observation.sigma_px,
                                          ShiftSigma(observation.motion, state_.rolling_shutter_s));
      }
      result_.corners.emplace_back(point3D_id, element);
      result_.corner_sigmas_px.push_back(observation.sigma_px);
    }
    result_.corner_residuals.push_back(AddResidual(
        std::make_unique<MarkerViewError>(camera.model, static_cast<int>(marker->corners.size()),
                                          std::move(observations), weights_.corner_correlation,
                                          weights_.loss_sigmas),
        {marker->x_in_world.data(), block.cam_from_world.data(), &state_.inset_px,
         state_.intrinsics.at(image.camera_id).data(), &state_.rolling_shutter_s}));
  }

  bool EstimatesInset() const { return options_.estimate_inset && options_.inset_sigma_px > 0; }

  IntrinsicsPrior PriorOf(const Camera& calibration) const {
    if (options_.find_camera) return UnknownCameraPrior(calibration);
    return MakeIntrinsicsPrior(calibration, FreeIntrinsicsOf(options_), options_.intrinsics_sigma);
  }

  const MarkerAdjustmentOptions& options_;
  const Model& model_;
  const MarkerWeights& weights_;
  MarkerState& state_;
  const double print_scale_sigma_ = PrintScaleSigma(options_, weights_);
  MarkerProblem result_;
};

}  // namespace

double PrintScaleSigma(const MarkerAdjustmentOptions& options, const MarkerWeights& weights) {
  return std::max(
      std::hypot(options.common_print_tolerance, weights.inset_as_scale, weights.chords_as_scale),
      weights.print_scale_by_bars);
}

MarkerProblem MakeMarkerProblem(const MarkerAdjustmentOptions& options, const Model& model,
                                const CornerErrors& corner_errors,
                                const std::map<CameraId, Camera>& calibration,
                                const MarkerWeights& weights, MarkerState* state) {
  ProblemBuilder builder(options, model, weights, state);
  builder.AddParameters(calibration);
  builder.AddCorners(corner_errors);
  builder.AddPriors(calibration);
  builder.AddScaleBars();
  return builder.Take();
}

int MinimizeMarkerProblem(int max_num_iterations, double function_tolerance,
                          MarkerProblem* problem) {
  SchurOptions options;
  options.max_num_iterations = max_num_iterations;
  options.function_tolerance = function_tolerance;
  options.keeps_last_step = true;
  // Callers use such a tolerance only near the minimum, where damping would only add iterations.
  if (function_tolerance < 1e-6) options.initial_trust_region_radius = 1e8;
  std::vector<double*> eliminated, kept;
  for (double* block : problem->marker_blocks) {
    (problem->kept_markers.count(block) == 0 ? eliminated : kept).push_back(block);
  }
  kept.insert(kept.end(), problem->global_blocks.begin(), problem->global_blocks.end());
  const SchurSummary summary =
      MinimizeBySchurComplement(options, eliminated, kept, problem->ceres.get());
  LogDebug("{} iterations, cost {:.6g} -> {:.6g}", summary.num_iterations, summary.initial_cost,
           summary.final_cost);
  if (!summary.is_usable) {
    throw DataError(
        "the bundle adjustment cannot compute a step: a corner lies behind the camera that sees "
        "it, or a number is not finite; take more pictures, from more sides");
  }
  return summary.num_iterations;
}

std::vector<double> CornerResiduals(const MarkerProblem& problem) {
  ceres::Problem::EvaluateOptions options;
  options.residual_blocks = problem.corner_residuals;
  std::vector<double> residuals;
  VELAMAP_CHECK(problem.ceres->Evaluate(options, nullptr, &residuals, nullptr, nullptr));
  return residuals;
}

}  // namespace velamap
