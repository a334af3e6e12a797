#include "reconstruct/adjust/marker_adjuster.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "importer/base/error.h"
#include "reconstruct/adjust/calibration_score.h"
#include "reconstruct/adjust/marker_sizes.h"
#include "reconstruct/adjust/scale_bar_verdict.h"
#include "reconstruct/colmap/bundle_adjustment_options.h"
#include "reconstruct/colmap/observation_filter.h"
#include "reconstruct/geometry/covariance_update.h"
#include "reconstruct/geometry/intrinsics_prior.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/reprojection.h"
#include "reconstruct/model/weak_geometry.h"
#include "reconstruct/problem/corner_residuals.h"
#include "reconstruct/problem/error_correlation.h"
#include "reconstruct/problem/marker_uncertainty.h"

namespace velamap {
namespace {

// The smallest factor of the corners' sigmas: exact corners would leave no weight to the priors.
constexpr double kMinCornerFactor = 1e-3;

void CheckEnough(const Model& model, std::size_t num_images_before) {
  if (model.images.size() >= 2 && !model.points3D.empty()) return;
  throw DataError(
      fmt::format("nothing is left to adjust: {} of {} images share enough corners with others",
                  model.images.size(), num_images_before));
}

MarkerWeights WithoutLoss(MarkerWeights weights) {
  weights.loss_sigmas = std::numeric_limits<double>::infinity();
  return weights;
}

// The world becomes the first image's camera.
void MoveToFirstCamera(Model* model) {
  const Rigid3 first_from_world = model->images.front().cam_from_world;
  TransformModel({1.0, first_from_world.rotation, first_from_world.translation}, model);
  model->images.front().cam_from_world = Rigid3{};  // exactly, without rounding
}

}  // namespace

MarkerAdjuster::MarkerAdjuster(const MarkerAdjustmentOptions& options, const Layout& layout,
                               const CornerSigmas& corner_sigmas, Model model)
    : options_(options),
      layout_(layout),
      corner_sigmas_(corner_sigmas),
      calibration_(model.cameras),
      num_images_before_(model.images.size()),
      model_(std::move(model)) {
  options_.inset_sigma_px = std::hypot(options.inset_sigma_px, corner_sigmas.common_inset_px);
}

void MarkerAdjuster::PrepareSeed() {
  summary_.error_before_px = SummarizeReprojectionErrors(ComputeReprojectionErrors(model_));
  RemoveSeedOutliers({}, &model_, &summary_.removed);
  RemoveUnderconstrainedParts();
  TransformModel({MedianScale(MakeMarkerState(model_, layout_)), Eigen::Quaterniond::Identity(),
                  Eigen::Vector3d::Zero()},
                 &model_);
  MoveToFirstCamera(&model_);
  state_ = MakeMarkerState(model_, layout_);
  if (!options_.estimate_inset && options_.inset_sigma_px > 0) {
    weights_.inset_as_scale = 2.0 * options_.inset_sigma_px / MedianSidePx(model_);
  }
}

void MarkerAdjuster::AdjustLoosely() {
  // In the first round the sides are almost free: in a rough seed, wrong sides would hold the
  // corners back.
  constexpr double kVeryLooseTolerance = 0.3;
  constexpr double kLooseTolerance = 0.02;
  constexpr int kMaxNumRounds = 8;
  constexpr double kMaxChange = 0.1;
  weights_.loss_sigmas = options_.loss_sigmas;
  CalibrateRobustly();
  for (int round = 0; round < kMaxNumRounds; ++round) {
    weights_.print_tolerance =
        std::max(round == 0 ? kVeryLooseTolerance : kLooseTolerance, options_.print_tolerance);
    Minimize(1e-3);
    if (CalibrateRobustly() < kMaxChange && round > 0) break;
  }
}

void MarkerAdjuster::RejectContradictingSizes() {
  const auto linearization = Linearize();
  const MarkerSizeVerdict verdict =
      JudgeMarkerSizes(linearization->state, linearization->covariance, options_.print_tolerance,
                       PrintScaleSigma(options_, weights_));
  weights_.print_tolerance = verdict.print_tolerance;
  weights_.markers_without_size = verdict.contradicting;
  weights_.part_scale_sigma = verdict.part_scale_sigma;
  part_disagreement_ = verdict.part_disagreement;
  summary_.warnings.insert(summary_.warnings.end(), verdict.warnings.begin(),
                           verdict.warnings.end());
}

void MarkerAdjuster::AdjustTightly() {
  constexpr int kMaxNumRounds = 10;
  constexpr double kMaxChange = 0.03;
  for (int round = 0; round < kMaxNumRounds; ++round) {
    Minimize(1e-4);
    const double change = CalibrateRobustly();
    const int num_changes = ReviseCorners();
    if (num_changes == 0 && change < kMaxChange) break;
  }
  if (RemoveUnprovenCorners(&model_, &summary_.removed)) {
    RemoveUnderconstrainedParts();
    Minimize(1e-4);
  }
}

void MarkerAdjuster::Free(const FreeIntrinsics& free, double sigma) {
  options_.refine_focal_length = free.focal_length;
  options_.refine_principal_point = free.principal_point;
  options_.refine_extra_params = free.distortion;
  options_.intrinsics_sigma = sigma;
  if (!free.distortion) return;
  for (auto& [camera_id, camera] : calibration_) {
    camera = WithDistortionParams(camera);
    model_.cameras.at(camera_id) = WithDistortionParams(model_.cameras.at(camera_id));
  }
}

double MarkerAdjuster::SumOfSquares() {
  MarkerState state = MakeState(model_);
  const MarkerProblem problem = MakeProblem(weights_, model_, &state);
  double cost = 0.0;
  VELAMAP_CHECK(problem.ceres->Evaluate({}, &cost, nullptr, nullptr, nullptr));
  return 2.0 * cost;
}

MarkerAdjuster::IntrinsicsVerdict MarkerAdjuster::JudgeIntrinsics(const FreeIntrinsics& free,
                                                                  double sigma) const {
  MarkerAdjuster trial = *this;
  trial.Free(free, sigma);
  const double before = trial.SumOfSquares();
  trial.Minimize(1e-4);
  IntrinsicsVerdict verdict;
  verdict.improvement = before - trial.SumOfSquares();
  int num_free = 0, num_corners = 0;
  for (const auto& [camera_id, camera] : trial.calibration_) {
    num_free += static_cast<int>(MakeIntrinsicsPrior(camera, free, sigma).free.size());
  }
  for (const auto& [point3D_id, point] : model_.points3D) {
    num_corners += static_cast<int>(point.track.size());
  }
  // The Bayesian information criterion (Schwarz, "Estimating the Dimension of a Model", 1978).
  verdict.criterion = verdict.needed = num_free * std::log(2.0 * num_corners);
  spdlog::debug("free intrinsics: the sum of squares falls by {:.1f}, {:.1f} needed",
                verdict.improvement, verdict.needed);
  if (!verdict.IsSignificant()) return verdict;
  if (!(FreeIntrinsicsOf(trial.options_) == free)) return verdict;  // the distortion folds over
  // The sigmas of the corners still contain the errors of the calibration.
  trial.CalibrateRobustly();
  trial.Minimize(1e-4);
  const auto linearization = trial.Linearize();
  // Errors that corners have in common explain a part of the improvement.
  const double factor = CorrelationFactor(
      linearization->state, linearization->problem, linearization->jacobian,
      linearization->covariance, GroupImages(model_, linearization->state), options_.num_threads);
  verdict.needed *= factor * factor;
  verdict.determined = free;
  for (const auto& [camera_id, camera] : trial.calibration_) {
    const Eigen::MatrixXd covariance =
        factor * factor *
        GlobalCovariance(linearization->problem, linearization->covariance,
                         linearization->state.intrinsics.at(camera_id).data());
    verdict.determined = DeterminedIntrinsics(
        verdict.determined, MakeIntrinsicsPrior(camera, free, options_.intrinsics_sigma),
        trial.model_.cameras.at(camera_id), covariance);
  }
  const FreeIntrinsics& found = verdict.determined;
  spdlog::debug(
      "{:.1f} needed with correlated errors; determined: focal length {}, principal point {}, "
      "distortion {}",
      verdict.needed, found.focal_length, found.principal_point, found.distortion);
  return verdict;
}

FreeIntrinsics MarkerAdjuster::ChooseIntrinsics(double sigma) const {
  const FreeIntrinsics all{true, true, true};
  const IntrinsicsVerdict first = JudgeIntrinsics(all, sigma);
  IntrinsicsVerdict verdict = first;
  FreeIntrinsics free = all;
  while (verdict.IsSignificant() && !(verdict.determined == free)) {
    free = verdict.determined;
    if (!free.Any()) return {};
    verdict = JudgeIntrinsics(free, sigma);
    // Parameters that are not determined but needed would be replaced by wrong values of others.
    const double needed_by_others = first.needed * (1.0 - verdict.criterion / first.criterion);
    if (first.improvement - verdict.improvement > needed_by_others) return {};
  }
  return verdict.IsSignificant() ? free : FreeIntrinsics{};
}

std::optional<MarkerAdjuster> MarkerAdjuster::WithBetterCalibration(MarkerAdjuster begin) const {
  // What a calibration that the images contradict still says, relative to its usual sigma.
  constexpr double kContradicted = 3.0;
  if (!options_.refine_calibration || FreeIntrinsicsOf(options_).Any()) return std::nullopt;
  const double sigma = kContradicted * options_.intrinsics_sigma;
  FreeIntrinsics free;
  try {
    free = ChooseIntrinsics(sigma);
    if (!free.Any()) return std::nullopt;
    begin.Free(free, sigma);
    begin.AdjustToCorners();
  } catch (const DataError& error) {
    spdlog::debug("not with free intrinsics: {}", error.what());
    return std::nullopt;
  }
  for (const auto& [camera_id, camera] : begin.model_.cameras) {
    const Camera& calibration = begin.calibration_.at(camera_id);
    const std::string text =
        fmt::format("the images contradict the calibration, which is refined: {}",
                    DescribeRefinement(calibration, camera));
    if (IsWithin(MakeIntrinsicsPrior(calibration, free, options_.intrinsics_sigma), camera)) {
      spdlog::info(text);
    } else {
      begin.summary_.warnings.push_back(
          fmt::format("{}; calibrate the camera again, or keep the given calibration by {} 0", text,
                      OptionName(&MarkerAdjustmentOptions::refine_calibration)));
    }
  }
  return begin;
}

void MarkerAdjuster::AdjustToCorners() {
  AdjustLoosely();
  RejectContradictingSizes();
  AdjustTightly();
}

bool MarkerAdjuster::AddScaleBars() {
  const std::vector<ScaleBar> bars = FindScaleBars(state_, layout_);
  ScaleBarVerdict verdict;
  if (!bars.empty()) {
    const auto linearization = Linearize();
    const Eigen::MatrixXd covariance_m2 = BarCovariance(
        bars, linearization->state, linearization->problem, linearization->covariance);
    verdict = JudgeScaleBars(bars, linearization->state, covariance_m2,
                             PrintScaleSigma(options_, weights_));
  }
  if (!part_disagreement_.empty()) {
    summary_.warnings.push_back(part_disagreement_ +
                                (verdict.used.empty()
                                     ? ": measure a distance on one of them (distances, use: scale)"
                                     : ": the measured distances decide"));
  }
  summary_.warnings.insert(summary_.warnings.end(), verdict.warnings.begin(),
                           verdict.warnings.end());
  weights_.scale_bars = std::move(verdict.used);
  if (verdict.print_scale_sigma > 0) {
    weights_.print_scale_by_bars = verdict.print_scale_sigma;
    TransformModel({verdict.scale, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()},
                   &model_);
    state_.print_scale = verdict.scale - 1.0;
  }
  return !weights_.scale_bars.empty();
}

void MarkerAdjuster::Finish() {
  // Another image is the first one where the first image has been removed.
  MoveToFirstCamera(&model_);
  auto linearization = CalibrateCorners();
  const double correlation_factor = CorrelationFactor(
      linearization->state, linearization->problem, linearization->jacobian,
      linearization->covariance, GroupImages(model_, linearization->state), options_.num_threads);
  if (correlation_factor > 1.0) {
    weights_.corner_factor *= correlation_factor;
    Minimize(1e-9);
    linearization = Linearize();
  }
  AdjustmentUncertainty uncertainty = MakeUncertainty(
      linearization->state, weights_, linearization->problem, linearization->covariance);
  uncertainty.variance_factor = summary_.uncertainty.variance_factor;
  uncertainty.share_above_4_sigma = summary_.uncertainty.share_above_4_sigma;
  uncertainty.correlation_factor = correlation_factor;
  uncertainty.calibration = TestCalibration(model_, linearization->state, linearization->problem,
                                            linearization->jacobian, linearization->covariance);
  uncertainty.calibration.shape_change_in_sigmas =
      uncertainty.calibration.shape_change_m /
      std::sqrt(Trace(uncertainty.points) /
                static_cast<double>(uncertainty.points.point3D_ids.size()));
  summary_.uncertainty = std::move(uncertainty);
  UpdatePointErrors(&model_);
  summary_.error_after_px = SummarizeReprojectionErrors(ComputeReprojectionErrors(model_));
  if (!(summary_.error_after_px.mean <= options_.max_mean_error_px)) {
    throw DataError(fmt::format(
        "the mean reprojection error is {:.2f} px after the bundle adjustment, above the {:.2f} px "
        "of {}; does the calibration belong to these images?",
        summary_.error_after_px.mean, options_.max_mean_error_px,
        OptionName(&BundleAdjustmentOptions::max_mean_error_px)));
  }
  for (const std::string& warning : FindWeakGeometry(model_, summary_.uncertainty.points)) {
    summary_.warnings.push_back(warning);
  }
}

std::unique_ptr<const MarkerAdjuster::Linearization> MarkerAdjuster::CalibrateCorners() {
  constexpr int kMaxNumRounds = 3;
  constexpr double kMaxChange = 0.01;
  constexpr double kManySigmas = 4.0;
  for (int round = 1; true; ++round) {
    Minimize(1e-9);
    auto linearization = Linearize();
    const double redundancy = CornerRedundancy(linearization->jacobian, linearization->covariance);
    double sum = 0.0;
    const std::vector<CornerResidual> corners = EvaluateCorners(linearization->problem);
    for (const CornerResidual& corner : corners) sum += corner.sigmas * corner.sigmas;
    const double variance = sum / std::max(1.0, redundancy);
    const double factor = std::max(kMinCornerFactor, weights_.corner_factor * std::sqrt(variance));
    const bool is_calibrated = std::abs(factor / weights_.corner_factor - 1.0) <= kMaxChange;
    if (round < kMaxNumRounds && !is_calibrated) {
      weights_.corner_factor = factor;
      continue;
    }
    const auto num_above =
        std::count_if(corners.begin(), corners.end(), [variance](const CornerResidual& corner) {
          return corner.sigmas > kManySigmas * std::sqrt(variance);
        });
    summary_.uncertainty.share_above_4_sigma =
        static_cast<double>(num_above) / static_cast<double>(corners.size());
    summary_.uncertainty.variance_factor =
        variance * weights_.corner_factor * weights_.corner_factor;
    return linearization;
  }
}

MarkerProblem MarkerAdjuster::MakeProblem(const MarkerWeights& weights, const Model& model,
                                          MarkerState* state) {
  return MakeMarkerProblem(options_, model, corner_sigmas_, calibration_, weights, state);
}

MarkerState MarkerAdjuster::MakeState(const Model& model) const {
  MarkerState state = MakeMarkerState(model, layout_);
  state.inset_px = state_.inset_px;
  state.print_scale = state_.print_scale;
  for (auto& [part, scale] : state.part_scales) scale = state_.part_scales.at(part);
  std::map<ImageId, std::array<double, 6>> velocities;
  for (const ImageBlock& image : state_.images) velocities[image.image_id] = image.velocity;
  for (ImageBlock& image : state.images) image.velocity = velocities.at(image.image_id);
  return state;
}

void MarkerAdjuster::Minimize(double function_tolerance) {
  state_ = MakeState(model_);
  MarkerWeights weights = weights_;
  weights.holds_print_scale = weights_.scale_bars.empty();
  MarkerProblem problem = MakeProblem(weights, model_, &state_);
  summary_.num_iterations +=
      MinimizeMarkerProblem(options_.max_num_iterations, function_tolerance, &problem);
  WriteMarkerState(state_, &model_);
  if (HoldFoldedDistortion()) Minimize(function_tolerance);
}

bool MarkerAdjuster::HoldFoldedDistortion() {
  if (!options_.refine_extra_params) return false;
  const bool is_folded =
      std::any_of(model_.cameras.begin(), model_.cameras.end(), [&](const auto& entry) {
        return !HasMonotonicDistortion(entry.second) &&
               HasMonotonicDistortion(calibration_.at(entry.first));
      });
  if (!is_folded) return false;
  options_.refine_extra_params = false;
  for (auto& [camera_id, camera] : model_.cameras) {
    const std::vector<double>& params = calibration_.at(camera_id).params;
    for (const int i : MakeIntrinsicsPrior(camera, {false, false, true}, 1.0).free) {
      camera.params[static_cast<std::size_t>(i)] = params[static_cast<std::size_t>(i)];
    }
  }
  summary_.warnings.push_back(
      "the distortion is not refined: the images do not determine it, and it would fold over "
      "inside the image");
  return true;
}

std::unique_ptr<const MarkerAdjuster::Linearization> MarkerAdjuster::Linearize() {
  auto linearization = std::make_unique<Linearization>();
  linearization->state = MakeState(model_);
  linearization->problem = MakeProblem(WithoutLoss(weights_), model_, &linearization->state);
  linearization->jacobian = EvaluateJacobian(linearization->problem);
  auto covariance = InvertNormalEquations(linearization->jacobian, options_.num_threads);
  if (!covariance) {
    throw DataError(
        "the images leave the shape undetermined: take them from more places, so that every marker "
        "is seen from different sides");
  }
  linearization->covariance = std::move(*covariance);
  return linearization;
}

std::vector<CornerResidual> MarkerAdjuster::EvaluateCornersOf(const Model& model) {
  MarkerState state = MakeState(model);
  return EvaluateCorners(MakeProblem(WithoutLoss(weights_), model, &state));
}

double MarkerAdjuster::CalibrateRobustly() {
  const double before = weights_.corner_factor;
  const double variance = RobustVarianceFactor(EvaluateCornersOf(model_), model_);
  weights_.corner_factor = std::max(kMinCornerFactor, before * std::sqrt(variance));
  spdlog::debug("corner sigmas times {:.4f}", weights_.corner_factor);
  return std::abs(weights_.corner_factor / before - 1.0);
}

int MarkerAdjuster::ReviseCorners() {
  using Key = std::pair<Point3DId, ImageId>;
  const auto keys_of = [](const std::vector<RemovedObservation>& observations) {
    std::set<Key> keys;
    for (const RemovedObservation& observation : observations) {
      keys.insert({observation.point3D_id, observation.element.image_id});
    }
    return keys;
  };
  const std::set<Key> before = keys_of(summary_.removed);
  std::vector<RemovedObservation> removed;
  Model candidate = model_;
  for (const RemovedObservation& observation : summary_.removed) {
    if (!RestoreObservation(observation, &candidate)) removed.push_back(observation);
  }
  RemoveOutliers(EvaluateCornersOf(candidate), options_.outlier_sigmas, &candidate, &removed);
  const std::set<Key> after = keys_of(removed);
  std::vector<Key> changes;
  std::set_symmetric_difference(before.begin(), before.end(), after.begin(), after.end(),
                                std::back_inserter(changes));
  model_ = std::move(candidate);
  summary_.removed = std::move(removed);
  RemoveUnderconstrainedParts();
  return static_cast<int>(changes.size());
}

void MarkerAdjuster::RemoveUnderconstrainedParts() {
  RemoveUnderconstrained(options_.min_track_length, &model_, &summary_.removed_images);
  CheckEnough(model_, num_images_before_);
}

}  // namespace velamap
