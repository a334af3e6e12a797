#include "reconstruct/adjust/marker_adjuster.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "importer/text/id_ranges.h"
#include "reconstruct/adjust/bent_markers.h"
#include "reconstruct/adjust/calibration_choice.h"
#include "reconstruct/adjust/camera_model_choice.h"
#include "reconstruct/adjust/corner_calibration.h"
#include "reconstruct/adjust/found_cameras.h"
#include "reconstruct/adjust/rolling_shutter_choice.h"
#include "reconstruct/colmap/bundle_adjustment_options.h"
#include "reconstruct/colmap/observation_filter.h"
#include "reconstruct/correlation/corner_correlation.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/reprojection.h"
#include "reconstruct/model/weak_geometry.h"
#include "reconstruct/problem/corner_residuals.h"
#include "reconstruct/problem/marker_uncertainty.h"
#include "reconstruct/problem/rolling_shutter.h"
#include "reconstruct/sizes/marker_sizes.h"
#include "reconstruct/sizes/moving_markers.h"
#include "reconstruct/sizes/runaway_markers.h"
#include "reconstruct/sizes/scale_bar_verdict.h"

namespace velamap {
namespace {

// 1 sigma of the size of each marker, as a fraction, due to the inset of its corners, which
// shortens a side by two insets.
std::map<int, double> InsetSigmas(const MarkerSolution& solution) {
  std::map<int, double> sigmas;
  for (const auto& [marker_id, side_px] : MeanSidesPx(solution.model)) {
    sigmas[marker_id] = 2.0 * solution.options.inset_sigma_px / side_px;
  }
  return sigmas;
}

}  // namespace

MarkerAdjuster::MarkerAdjuster(const MarkerAdjustmentOptions& options, const Layout& layout,
                               const CornerErrors& corner_errors, Model model)
    : num_images_before_(model.images.size()) {
  solution_.options = options;
  solution_.options.inset_sigma_px =
      std::hypot(options.inset_sigma_px, corner_errors.common_inset_px);
  solution_.layout = &layout;
  solution_.corner_errors = &corner_errors;
  solution_.calibration = model.cameras;
  solution_.weights.corner_correlation = kUsualCornerCorrelation;
  solution_.model = std::move(model);
}

MarkerAdjustmentSummary MarkerAdjuster::TakeSummary() {
  summary_.num_iterations = solution_.num_iterations;
  summary_.warnings = std::move(solution_.warnings);
  return std::move(summary_);
}

void MarkerAdjuster::PrepareSeed() {
  summary_.error_before_px = SummarizeReprojectionErrors(solution_.model);
  RemoveSeedOutliers({}, &solution_.model, &summary_.removed);
  RemoveUnderconstrainedParts();
  TransformModel(Sim3{MetresPerUnit(MakeMarkerState(solution_.model, *solution_.layout))},
                 &solution_.model);
  MoveToFirstCamera(&solution_.model);
  const std::vector<int> runaway_ids = PlaceRunawayMarkersAnew(*solution_.layout, &solution_.model);
  if (!runaway_ids.empty()) {
    LogDebug("markers of an impossible size, placed anew: {}", IdRanges(runaway_ids));
  }
  solution_.state = MakeMarkerState(solution_.model, *solution_.layout);
  if (!solution_.options.estimate_inset && solution_.options.inset_sigma_px > 0) {
    solution_.weights.inset_as_scale =
        2.0 * solution_.options.inset_sigma_px / MedianSidePx(solution_.model);
  }
  seed_ = {solution_, summary_};
}

void MarkerAdjuster::RestoreSeed() {
  solution_ = seed_.solution;
  summary_ = seed_.summary;
  part_disagreement_.clear();
}

void MarkerAdjuster::AdjustWithLooseSizes() {
  // In the first round the sides are almost free: in a rough seed, wrong sides would hold the
  // corners back.
  constexpr double kVeryLooseTolerance = 0.3;
  constexpr double kLooseTolerance = 0.02;
  constexpr int kMaxNumRounds = 8;
  constexpr double kMaxChange = 0.1;
  solution_.weights.loss_sigmas = solution_.options.loss_sigmas;
  CalibrateRobustly(&solution_);
  for (int round = 0; round < kMaxNumRounds; ++round) {
    solution_.weights.print_tolerance = std::max(round == 0 ? kVeryLooseTolerance : kLooseTolerance,
                                                 solution_.options.print_tolerance);
    Minimize(1e-3, &solution_);
    if (CalibrateRobustly(&solution_) < kMaxChange && round > 0) break;
  }
}

void MarkerAdjuster::RejectContradictingSizes() {
  const auto linearization = Linearize(solution_);
  const MarkerSizeVerdict verdict =
      JudgeMarkerSizes(linearization->state, linearization->covariance,
                       SizeCorrelationFactor(solution_, *linearization), InsetSigmas(solution_),
                       solution_.options, PrintScaleSigma(solution_.options, solution_.weights));
  solution_.weights.corner_correlation = EstimateCornerCorrelation(
      linearization->problem, linearization->jacobian, linearization->covariance);
  solution_.weights.print_tolerance = verdict.print_tolerance;
  solution_.weights.markers_without_size = verdict.contradicting;
  solution_.weights.part_scale_sigma = verdict.part_scale_sigma;
  part_disagreement_ = verdict.part_disagreement;
  solution_.warnings.insert(solution_.warnings.end(), verdict.warnings.begin(),
                            verdict.warnings.end());
}

void MarkerAdjuster::AdjustWithSizes() {
  constexpr int kMaxNumRounds = 10;
  constexpr double kMaxChange = 0.03;
  for (int round = 0; round < kMaxNumRounds; ++round) {
    Minimize(1e-4, &solution_);
    const double change = CalibrateRobustly(&solution_);
    const int num_changes = ReviseCorners();
    if (num_changes == 0 && change < kMaxChange) break;
  }
  if (RemoveUnprovenCorners(&solution_.model, &summary_.removed)) {
    RemoveUnderconstrainedParts();
    Minimize(1e-4, &solution_);
  }
}

void MarkerAdjuster::AllowForMotion() {
  // Markers were where most of their images show them, and come to be where the mean of all does.
  constexpr int kNumRounds = 3;
  for (int round = 0; round < kNumRounds; ++round) {
    std::vector<RemovedObservation> lost;
    std::map<int, double> factors = MotionFactorsOf(WithRemovedCorners(&lost), solution_);
    if (factors.empty() && solution_.weights.marker_factors.empty()) return;
    solution_.weights.marker_factors = std::move(factors);
    AdjustWithSizes();
  }
  std::vector<int> moving_ids;
  for (const auto& [marker_id, factor] : solution_.weights.marker_factors) {
    moving_ids.push_back(marker_id);
  }
  if (!moving_ids.empty()) {
    LogInfo("markers that move relative to the others, which their sigmas contain: {}",
            IdRanges(moving_ids));
  }
}

void MarkerAdjuster::RefineCalibration() {
  const std::optional<RefinedIntrinsics> refined = ChooseIntrinsics(solution_);
  if (!refined) return;
  MarkerAdjuster better = *this;
  better.RestoreSeed();
  SetFreeIntrinsics(refined->free, refined->sigma, &better.solution_);
  try {
    better.AdjustToCorners();
  } catch (const DataError& error) {
    LogDebug("the calibration is not refined: {}", error.what());
    return;
  }
  ReportRefinement(refined->free, solution_.options.intrinsics_sigma, &better.solution_);
  *this = std::move(better);
}

std::vector<CameraModelScore> MarkerAdjuster::CrossValidateCameraModel(
    std::optional<CameraModel> wanted) {
  solution_ = WithMostFlexibleModel(solution_);
  AdjustWithSizes();
  CrossValidation result = CrossValidateCameraModels(solution_, wanted);
  solution_ = std::move(result.best);
  return std::move(result.scores);
}

void MarkerAdjuster::WidenCameraSigmas() {
  MarkerSolution as_recorded = solution_;
  as_recorded.model = as_recorded_;
  for (auto& [camera_id, sigmas] : JackknifeCameras(as_recorded)) {
    EstimatedCamera& found = summary_.cameras.at(camera_id);
    AddInset(solution_.weights.inset_as_scale, found.camera, &sigmas);
    for (std::size_t i = 0; i < sigmas.size(); ++i) {
      found.sigmas[i] = std::max(found.sigmas[i], sigmas[i]);
    }
  }
}

void MarkerAdjuster::ChooseCameraModel() { solution_ = WithBestCameraModel(solution_); }

void MarkerAdjuster::AdjustToCorners() {
  AdjustWithLooseSizes();
  AdjustToBentMarkers(summary_.removed, &solution_);
  RejectContradictingSizes();
  AdjustWithSizes();
}

void MarkerAdjuster::AdjustFromSeed() {
  AdjustToCorners();
  if (!ShowsRollingShutter(solution_)) return;
  seed_.solution.weights.frees_rolling_shutter = true;
  RestoreSeed();
  AdjustToCorners();
}

bool MarkerAdjuster::AddScaleBars() {
  const std::vector<KnownDistance>& distances = solution_.layout->distances;
  ScaleBarVerdict verdict;
  if (!FindScaleBars(MakeMarkerState(solution_.model, *solution_.layout), distances).empty()) {
    const auto linearization = Linearize(solution_);
    const std::vector<ScaleBar> bars = FindScaleBars(linearization->state, distances);
    const Eigen::MatrixXd covariance_m2 = BarCovariance(
        bars, linearization->state, linearization->problem, linearization->covariance);
    verdict = JudgeScaleBars(bars, linearization->state, covariance_m2,
                             PrintScaleSigma(solution_.options, solution_.weights));
  }
  if (!part_disagreement_.empty()) {
    solution_.warnings.push_back(
        part_disagreement_ + (verdict.used.empty()
                                  ? ": measure a distance on one of them (distances, use: scale)"
                                  : ": the measured distances decide"));
  }
  solution_.warnings.insert(solution_.warnings.end(), verdict.warnings.begin(),
                            verdict.warnings.end());
  solution_.weights.scale_bars = std::move(verdict.used);
  if (verdict.print_scale_sigma > 0) {
    solution_.weights.print_scale_by_bars = verdict.print_scale_sigma;
    TransformModel(Sim3{verdict.scale}, &solution_.model);
    solution_.state.print_scale = verdict.scale - 1.0;
  }
  return !solution_.weights.scale_bars.empty();
}

void MarkerAdjuster::Finish() {
  // The first image may have been removed, which makes another one the first.
  MoveToFirstCamera(&solution_.model);
  CornerCalibration calibration = CalibrateBySquares(&solution_);
  auto linearization = std::move(calibration.linearization);
  const double correlation_factor = ShapeCorrelationFactor(solution_, *linearization);
  if (correlation_factor > 1.0) {
    solution_.weights.corner_factor *= correlation_factor;
    Minimize(1e-9, &solution_);
    linearization = Linearize(solution_);
  }
  summary_.uncertainty = UncertaintyOf(solution_, *linearization);
  summary_.uncertainty.variance_factor = calibration.variance_factor;
  summary_.uncertainty.share_above_4_sigma = calibration.share_above_4_sigma;
  summary_.uncertainty.correlation_factor = correlation_factor;
  const std::vector<std::string> lost =
      LostScaleBars(solution_.weights.scale_bars, linearization->state);
  solution_.warnings.insert(solution_.warnings.end(), lost.begin(), lost.end());
  WarnOfSlowShutter(summary_.uncertainty, &solution_);
  if (solution_.options.find_camera) {
    as_recorded_ = solution_.model;
    summary_.cameras = CamerasOf(solution_.model, *linearization);
    WidenToOpenCV(solution_, &summary_.cameras);
    for (auto& [camera_id, found] : summary_.cameras) {
      AddInset(solution_.weights.inset_as_scale, found.camera, &found.sigmas);
    }
  }
  solution_.model = ModelAtMiddleRow();
  UpdatePointErrors(&solution_.model);
  summary_.error_after_px = SummarizeReprojectionErrors(solution_.model);
  CheckMeanError(summary_.error_after_px.mean, solution_.options.max_mean_error_px,
                 !solution_.options.find_camera);
  const std::string weakness = FindWeakGeometry(solution_.model, summary_.uncertainty.points);
  if (solution_.options.find_camera) CheckFocalLength(summary_.cameras, weakness);
  if (!weakness.empty()) solution_.warnings.push_back(weakness);
}

std::map<CameraId, EstimatedCamera> MarkerAdjuster::EstimateCameras() const {
  const auto linearization = Linearize(solution_);
  const double correlation_factor = ShapeCorrelationFactor(solution_, *linearization);
  std::map<CameraId, EstimatedCamera> cameras = CamerasOf(solution_.model, *linearization);
  for (auto& [camera_id, found] : cameras) {
    for (double& sigma : found.sigmas) sigma *= correlation_factor;
  }
  return cameras;
}

Model MarkerAdjuster::ModelAtMiddleRow() const {
  Model model = solution_.model;
  MoveToMiddleRow(solution_.state.rolling_shutter_s, solution_.corner_errors->motions, &model);
  return model;
}

Model MarkerAdjuster::WithRemovedCorners(std::vector<RemovedObservation>* lost) const {
  constexpr double kAnyError = std::numeric_limits<double>::infinity();
  Model model = solution_.model;
  for (const RemovedObservation& observation : summary_.removed) {
    if (!RestoreObservation(observation, kAnyError, &model)) lost->push_back(observation);
  }
  return model;
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
  Model candidate = WithRemovedCorners(&removed);
  const double max_sigmas = solution_.options.outlier_sigmas;
  RemoveOutliers(WithoutMovedViews(ResidualsOfModel(candidate, solution_), max_sigmas, candidate,
                                   solution_.corner_errors->motions),
                 max_sigmas, &candidate, &removed);
  const std::set<Key> after = keys_of(removed);
  std::vector<Key> changes;
  std::set_symmetric_difference(before.begin(), before.end(), after.begin(), after.end(),
                                std::back_inserter(changes));
  solution_.model = std::move(candidate);
  summary_.removed = std::move(removed);
  RemoveUnderconstrainedParts();
  return static_cast<int>(changes.size());
}

void MarkerAdjuster::RemoveUnderconstrainedParts() {
  RemoveUnderconstrained(solution_.options.min_track_length, &solution_.model,
                         &summary_.removed_images);
  CheckEnough(solution_.model, num_images_before_, summary_.removed.size());
}

}  // namespace velamap
