#include "reconstruct/adjust/marker_solution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "importer/base/error.h"
#include "importer/base/statistics.h"
#include "reconstruct/adjust/calibration_score.h"
#include "reconstruct/colmap/bundle_adjustment_options.h"
#include "reconstruct/correlation/corner_correlation.h"
#include "reconstruct/correlation/error_correlation.h"
#include "reconstruct/geometry/covariance_update.h"
#include "reconstruct/problem/marker_uncertainty.h"
#include "reconstruct/problem/rolling_shutter.h"
#include "reconstruct/problem/scale_bar.h"
#include "reconstruct/sizes/moving_markers.h"
#include "reconstruct/sizes/size_deviations.h"
#include "reconstruct/sizes/student_factor.h"

namespace velamap {
namespace {

MarkerWeights WithoutLoss(MarkerWeights weights) {
  weights.loss_sigmas = std::numeric_limits<double>::infinity();
  return weights;
}

MarkerProblem MakeProblem(const MarkerSolution& solution, const MarkerWeights& weights,
                          const Model& model, MarkerState* state) {
  return MakeMarkerProblem(solution.options, model, *solution.corner_errors, solution.calibration,
                           weights, state);
}

// The parameters of `model`, which has no images or markers that the solution lacks.
MarkerState MakeState(const MarkerSolution& solution, const Model& model) {
  MarkerState state = MakeMarkerState(model, *solution.layout);
  state.rolling_shutter_s = solution.state.rolling_shutter_s;
  state.inset_px = solution.state.inset_px;
  state.print_scale = solution.state.print_scale;
  for (auto& [part, scale] : state.part_scales) scale = solution.state.part_scales.at(part);
  for (MarkerBlock& marker : state.markers) {
    const auto known = solution.chords.find(marker.marker_id);
    if (known != solution.chords.end()) marker.chords = known->second;
  }
  return state;
}

// Resets the distortion to the calibration and holds it there if the adjustment has made it fold
// over. Returns whether it has. Throws InputError if the user has asked for its refinement.
bool HoldFoldedDistortion(MarkerSolution* solution) {
  const MarkerAdjustmentOptions& options = solution->options;
  if (!options.refine_extra_params || options.find_camera) return false;
  Model& model = solution->model;
  const auto folded =
      std::find_if(model.cameras.begin(), model.cameras.end(), [&](const auto& entry) {
        return !HasMonotonicDistortion(entry.second) &&
               HasMonotonicDistortion(solution->calibration.at(entry.first));
      });
  if (folded == model.cameras.end()) return false;
  if (!solution->has_chosen_intrinsics) ThrowFoldedDistortion(folded->first);
  solution->options.refine_extra_params = false;
  for (auto& [camera_id, camera] : model.cameras) {
    const std::vector<double>& params = solution->calibration.at(camera_id).params;
    for (const int i : MakeIntrinsicsPrior(camera, {false, false, true}, 1.0).free) {
      camera.params[static_cast<std::size_t>(i)] = params[static_cast<std::size_t>(i)];
    }
  }
  solution->warnings.push_back(
      "the distortion is not refined: the images do not determine it, and it would fold over "
      "inside the image");
  return true;
}

// The residuals of the corners that are shifted by 1 sigma of the velocity error that the corners
// of an image share: one column for the velocity along x, one for that along y.
RowMajorMatrix SharedShiftErrors(const MarkerSolution& solution,
                                 const MarkerLinearization& linearization) {
  const MarkerProblem& problem = linearization.problem;
  std::map<ImageId, const ModelImage*> images;
  for (const ModelImage& image : solution.model.images) images[image.image_id] = &image;
  RowMajorMatrix errors =
      RowMajorMatrix::Zero(2 * static_cast<Eigen::Index>(problem.corners.size()), 2);
  for (std::size_t i = 0; i < problem.corners.size(); ++i) {
    const auto& [image_id, point2D_idx] = problem.corners[i].second;
    const auto motions = solution.corner_errors->motions.find(image_id);
    if (motions == solution.corner_errors->motions.end()) continue;
    const ModelImage& image = *images.at(image_id);
    const RowMotion motion =
        RowMotionOf(solution.model.cameras.at(image.camera_id),
                    image.points2D[point2D_idx].x_in_image_px, motions->second.at(point2D_idx));
    const double shift_px =
        linearization.state.rolling_shutter_s * motion.row * motion.motion.shared_sigma_px_s;
    const auto row = 2 * static_cast<Eigen::Index>(i);
    errors(row, 0) = errors(row + 1, 1) = shift_px;
  }
  PixelsToResiduals(problem, &errors);
  return errors;
}

}  // namespace

void SetFreeIntrinsics(const FreeIntrinsics& free, double sigma, MarkerSolution* solution) {
  MarkerAdjustmentOptions& options = solution->options;
  options.refine_focal_length = free.focal_length;
  options.refine_principal_point = free.principal_point;
  options.refine_extra_params = free.distortion;
  options.intrinsics_sigma = sigma;
  solution->has_chosen_intrinsics = true;
  if (!free.distortion) return;
  for (auto& [camera_id, camera] : solution->calibration) {
    camera = WithDistortionParams(camera);
    Camera& of_model = solution->model.cameras.at(camera_id);
    of_model = WithDistortionParams(of_model);
  }
}

void Minimize(double function_tolerance, MarkerSolution* solution) {
  solution->state = MakeState(*solution, solution->model);
  MarkerWeights weights = solution->weights;
  weights.holds_print_scale = FindScaleBars(solution->state, weights.scale_bars).empty();
  MarkerProblem problem = MakeProblem(*solution, weights, solution->model, &solution->state);
  solution->num_iterations +=
      MinimizeMarkerProblem(solution->options.max_num_iterations, function_tolerance, &problem);
  WriteMarkerState(solution->state, &solution->model);
  if (HoldFoldedDistortion(solution)) Minimize(function_tolerance, solution);
}

std::unique_ptr<const MarkerLinearization> Linearize(const MarkerSolution& solution) {
  auto linearization = std::make_unique<MarkerLinearization>();
  linearization->state = MakeState(solution, solution.model);
  linearization->problem =
      MakeProblem(solution, WithoutLoss(solution.weights), solution.model, &linearization->state);
  linearization->jacobian = EvaluateJacobian(linearization->problem);
  auto covariance = InvertNormalEquations(linearization->jacobian, solution.options.num_threads);
  if (!covariance) {
    throw DataError(
        "the images leave the shape undetermined: take them from more places, so that every marker "
        "is seen from different sides");
  }
  linearization->covariance = std::move(*covariance);
  return linearization;
}

double ShapeCorrelationFactor(const MarkerSolution& solution,
                              const MarkerLinearization& linearization) {
  return CorrelationFactor(
      linearization.state, linearization.problem, linearization.jacobian, linearization.covariance,
      GroupImages(solution.model, kNumCorrelationGroups), solution.options.num_threads);
}

double SizeCorrelationFactor(const MarkerSolution& solution,
                             const MarkerLinearization& linearization) {
  const auto& [state, problem, jacobian, covariance] = linearization;
  return CorrelationFactorOf(SizesByPoints(state, covariance), state, problem, jacobian, covariance,
                             GroupImages(solution.model, kNumCorrelationGroups),
                             solution.options.num_threads);
}

double ShutterSigma(double independent_sigma_s, const MarkerSolution& solution,
                    const MarkerLinearization& linearization) {
  // Codecs predict a frame from others as if all its rows had moved alike. On rendered walls, H.264
  // makes the time 0.1 to 0.9 % shorter, 0.7 % RMS; without loss it is right to 0.1 %. Noise of the
  // corners makes it shorter, too: in two clips of shaky hands, white noise of 0.1 px by 2 to 3 %.
  constexpr double kOfTime = 0.007, kOfTimeByNoise_1_px = 0.15;
  const auto& [state, problem, jacobian, covariance] = linearization;
  const int column = GlobalColumn(problem, &state.rolling_shutter_s);
  const std::vector<int> groups = GroupImages(solution.model, kNumCorrelationGroups);
  const double of_groups = GlobalCorrelationFactor(state, problem, jacobian, covariance, groups,
                                                   column, solution.options.num_threads);
  const int num_groups = 1 + *std::max_element(groups.begin(), groups.end());
  const double factor = num_groups > 1 ? of_groups * StudentFactor(num_groups - 1) : of_groups;
  const double by_motion_s = SigmaByImageErrors(problem, jacobian, covariance, column,
                                                SharedShiftErrors(solution, linearization));
  const double noise_px = Median(problem.corner_sigmas_px);
  const double by_bias_s =
      std::hypot(kOfTime, kOfTimeByNoise_1_px * noise_px) * state.rolling_shutter_s;
  return std::hypot(factor * independent_sigma_s, by_motion_s, by_bias_s);
}

AdjustmentUncertainty UncertaintyOf(const MarkerSolution& solution,
                                    const MarkerLinearization& linearization) {
  AdjustmentUncertainty uncertainty =
      MakeUncertainty(solution.options, linearization.state, solution.weights,
                      linearization.problem, linearization.covariance);
  uncertainty.markers_bend = !solution.chords.empty();
  if (solution.weights.scale_bars.empty()) {
    uncertainty.print_scale_sigma =
        std::min(solution.options.common_print_tolerance, uncertainty.relative_scale_sigma);
  }
  if (solution.weights.frees_rolling_shutter) {
    uncertainty.rolling_shutter_sigma_s =
        ShutterSigma(uncertainty.rolling_shutter_sigma_s, solution, linearization);
  }
  uncertainty.calibration = TestCalibration(solution.model, linearization);
  uncertainty.calibration.shape_change_in_sigmas =
      uncertainty.calibration.shape_change_m /
      std::sqrt(Trace(uncertainty.points) /
                static_cast<double>(uncertainty.points.point3D_ids.size()));
  return uncertainty;
}

std::vector<CornerResidual> ResidualsOfModel(const Model& model, const MarkerSolution& solution) {
  MarkerState state = MakeState(solution, model);
  MarkerWeights weights = WithoutLoss(solution.weights);
  weights.corner_correlation = 0.0;  // each corner by itself
  return EvaluateCorners(MakeProblem(solution, weights, model, &state));
}

std::map<int, double> MotionFactorsOf(const Model& model, const MarkerSolution& solution) {
  MarkerState state = MakeState(solution, model);
  return MotionFactors(MakeProblem(solution, WithoutLoss(solution.weights), model, &state),
                       solution.weights.marker_factors, model);
}

double SumOfSquares(const MarkerSolution& solution) {
  MarkerState state = MakeState(solution, solution.model);
  const MarkerProblem problem = MakeProblem(solution, solution.weights, solution.model, &state);
  double cost = 0.0;
  VELAMAP_CHECK(problem.ceres->Evaluate({}, &cost, nullptr, nullptr, nullptr));
  return 2.0 * cost;
}

double InformationCriterion(int num_parameters, const MarkerSolution& solution) {
  int num_corners = 0;
  for (const auto& [point3D_id, point] : solution.model.points3D) {
    num_corners += static_cast<int>(point.track.size());
  }
  return num_parameters * std::log(2.0 * num_corners);
}

}  // namespace velamap
