#include "reconstruct/adjust/marker_adjuster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "importer/base/error.h"
#include "reconstruct/adjust/error_correlation.h"
#include "reconstruct/adjust/marker_sizes.h"
#include "reconstruct/adjust/marker_uncertainty.h"
#include "reconstruct/adjust/weak_geometry.h"
#include "reconstruct/colmap/observation_filter.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/reprojection.h"

namespace velamap {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Below this factor the corners are exact and the priors would be as nothing.
constexpr double kMinCornerFactor = 1e-3;

void CheckEnough(const Model& model, std::size_t num_images_before) {
  if (model.images.size() >= 2 && !model.points3D.empty()) return;
  throw DataError(
      fmt::format("nothing is left to adjust: {} of {} images share enough corners with others",
                  model.images.size(), num_images_before));
}

// The observation is back in the model, if its image and point are and it lies in front.
bool Restore(const RemovedObservation& observation, Model* model) {
  const auto point = model->points3D.find(observation.point3D_id);
  const auto image = std::find_if(model->images.begin(), model->images.end(),
                                  [&observation](const ModelImage& other) {
                                    return other.image_id == observation.element.image_id;
                                  });
  if (point == model->points3D.end() || image == model->images.end()) return false;
  if (!((image->cam_from_world * point->second.x_in_world).z() > 0)) return false;
  image->points2D.at(observation.element.point2D_idx).point3D_id = observation.point3D_id;
  point->second.track.push_back(observation.element);
  return true;
}

MarkerWeights WithoutLoss(MarkerWeights weights) {
  weights.loss_sigmas = kInfinity;
  return weights;
}

// Of the markers' sides in the images; infinite where no image sees two neighbouring corners.
double MedianSidePx(const Model& model) {
  std::vector<double> sides_px;
  for (const ModelImage& image : model.images) {
    std::map<Point3DId, Eigen::Vector2d> corners_px;
    for (const Point2D& point : image.points2D) {
      if (point.point3D_id != kInvalidPoint3DId) corners_px[point.point3D_id] = point.x_in_image_px;
    }
    for (const auto& [point3D_id, corner_px] : corners_px) {
      const CornerId id = CornerFromPoint3DId(point3D_id);
      const auto next =
          corners_px.find(Point3DIdFromCorner({id.marker_id, id.corner % kNumCorners + 1}));
      if (next != corners_px.end()) sides_px.push_back((next->second - corner_px).norm());
    }
  }
  return sides_px.empty() ? kInfinity : Median(std::move(sides_px));
}

double ReprojectionErrorPx(const Model& model, Point3DId point3D_id, const TrackElement& element) {
  const ModelImage& image = *model.FindImage(element.image_id);
  const auto projection =
      ImageFromCam(model.cameras.at(image.camera_id),
                   image.cam_from_world * model.points3D.at(point3D_id).x_in_world);
  if (!projection) return kInfinity;
  return (*projection - image.points2D.at(element.point2D_idx).x_in_image_px).norm();
}

}  // namespace

MarkerAdjuster::MarkerAdjuster(const MarkerAdjustmentOptions& options, const Layout& layout,
                               const CornerSigmas& corner_sigmas, Model model)
    : options_(options),
      layout_(layout),
      corner_sigmas_(corner_sigmas),
      calibration_(model.cameras),
      num_images_before_(model.images.size()),
      model_(std::move(model)) {}

void MarkerAdjuster::PrepareSeed() {
  summary_.error_before_px = SummarizeReprojectionErrors(ComputeReprojectionErrors(model_));
  RemoveSeedOutliers({}, &model_, &summary_.removed);
  RemoveUnderconstrainedParts();
  TransformModel({MedianScale(MakeMarkerState(model_, layout_)), Eigen::Quaterniond::Identity(),
                  Eigen::Vector3d::Zero()},
                 &model_);
  const Rigid3 first_from_world = model_.images.front().cam_from_world;
  TransformModel({1.0, first_from_world.rotation, first_from_world.translation}, &model_);
  model_.images.front().cam_from_world = Rigid3{};  // exactly, without rounding
  state_ = MakeMarkerState(model_, layout_);
  if (!options_.estimate_inset && options_.inset_sigma_px > 0) {
    weights_.inset_as_scale = 2.0 * options_.inset_sigma_px / MedianSidePx(model_);
  }
}

void MarkerAdjuster::AdjustLoosely() {
  // In a rough seed the images have to untangle the corners before squares can help.
  constexpr double kVeryLooseTolerance = 0.3;
  constexpr double kLooseTolerance = 0.02;
  constexpr int kMaxNumRounds = 8;
  constexpr double kEnough = 0.1;
  weights_.loss_sigmas = options_.loss_sigmas;
  CalibrateRobustly();
  for (int round = 0; round < kMaxNumRounds; ++round) {
    weights_.print_tolerance =
        std::max(round == 0 ? kVeryLooseTolerance : kLooseTolerance, options_.print_tolerance);
    Solve(1e-3);
    if (CalibrateRobustly() < kEnough && round > 0) break;
  }
}

void MarkerAdjuster::JudgeMarkerSizes() {
  const auto linearisation = Linearise();
  const MarkerSizeVerdict verdict = velamap::JudgeMarkerSizes(
      linearisation->state, linearisation->covariance, options_.print_tolerance);
  weights_.print_tolerance = verdict.print_tolerance;
  weights_.markers_without_size = verdict.contradicting;
  summary_.warnings.insert(summary_.warnings.end(), verdict.warnings.begin(),
                           verdict.warnings.end());
}

void MarkerAdjuster::AdjustTightly() {
  constexpr int kMaxNumRounds = 10;
  constexpr double kEnough = 0.03;
  for (int round = 0; round < kMaxNumRounds; ++round) {
    Solve(1e-4);
    const double change = CalibrateRobustly();
    const int num_changes = ReviseCorners();
    if (num_changes == 0 && change < kEnough) break;
  }
  if (RemoveUnprovenCorners(&model_, &summary_.removed)) {
    RemoveUnderconstrainedParts();
    Solve(1e-4);
  }
}

bool MarkerAdjuster::AddScaleBars() {
  const std::vector<ScaleBar> bars = FindScaleBars(state_, layout_);
  if (bars.empty()) return false;
  const auto linearisation = Linearise();
  const MarkerState& state = linearisation->state;
  const PointCovariance points = PointsOf(state, linearisation->covariance);
  for (const ScaleBar& bar : bars) {
    const std::string contradiction = FindContradiction(bar, state, points);
    if (contradiction.empty()) {
      weights_.scale_bars.push_back(bar);
    } else {
      summary_.warnings.push_back(contradiction);
    }
  }
  return !weights_.scale_bars.empty();
}

void MarkerAdjuster::Finish() {
  // The first image may have been removed on the way.
  const Rigid3 first_from_world = model_.images.front().cam_from_world;
  TransformModel({1.0, first_from_world.rotation, first_from_world.translation}, &model_);
  model_.images.front().cam_from_world = Rigid3{};
  auto linearisation = CalibrateCorners();
  const double correlation_factor =
      CorrelationFactor(linearisation->state, linearisation->problem, linearisation->covariance,
                        GroupImages(model_, linearisation->state));
  if (correlation_factor > 1.0) {
    weights_.corner_factor *= correlation_factor;
    Solve(1e-9);
    linearisation = Linearise();
  }
  AdjustmentUncertainty uncertainty = MakeUncertainty(
      linearisation->state, weights_, linearisation->problem, linearisation->covariance);
  uncertainty.variance_factor = summary_.uncertainty.variance_factor;
  uncertainty.share_above_4_sigma = summary_.uncertainty.share_above_4_sigma;
  uncertainty.correlation_factor = correlation_factor;
  summary_.uncertainty = std::move(uncertainty);
  UpdatePointErrors(&model_);
  summary_.error_after_px = SummarizeReprojectionErrors(ComputeReprojectionErrors(model_));
  if (!(summary_.error_after_px.mean <= options_.max_mean_error_px)) {
    throw DataError(fmt::format(
        "the mean reprojection error is {:.2f} px after the bundle adjustment, above the {:.2f} px "
        "of --BundleAdjustment.max_mean_error; is the calibration of these images?",
        summary_.error_after_px.mean, options_.max_mean_error_px));
  }
  for (const std::string& warning : FindWeakGeometry(model_, summary_.uncertainty.points)) {
    summary_.warnings.push_back(warning);
  }
}

std::unique_ptr<const MarkerAdjuster::Linearisation> MarkerAdjuster::CalibrateCorners() {
  constexpr int kMaxNumRounds = 3;
  constexpr double kEnough = 0.01;
  constexpr double kManySigmas = 4.0;
  for (int round = 1; true; ++round) {
    Solve(1e-9);
    auto linearisation = Linearise();
    const MarkerProblem& problem = linearisation->problem;
    const double redundancy = CornerRedundancy(problem, linearisation->covariance);
    double sum = 0.0;
    const std::vector<CornerResidual> corners = EvaluateCorners(problem);
    for (const CornerResidual& corner : corners) sum += corner.sigmas * corner.sigmas;
    const double variance = sum / std::max(1.0, redundancy);
    const double factor = std::max(kMinCornerFactor, weights_.corner_factor * std::sqrt(variance));
    const bool is_calibrated = std::abs(factor / weights_.corner_factor - 1.0) <= kEnough;
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
    return linearisation;
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
  std::map<ImageId, std::array<double, 6>> velocities;
  for (const ImageBlock& image : state_.images) velocities[image.image_id] = image.velocity;
  for (ImageBlock& image : state.images) image.velocity = velocities.at(image.image_id);
  return state;
}

void MarkerAdjuster::Solve(double function_tolerance) {
  state_ = MakeState(model_);
  MarkerWeights weights = weights_;
  weights.holds_print_scale = weights_.scale_bars.empty();
  MarkerProblem problem = MakeProblem(weights, model_, &state_);
  summary_.num_iterations +=
      SolveMarkerProblem(options_.max_num_iterations, function_tolerance, &problem);
  WriteMarkerState(state_, &model_);
}

std::unique_ptr<const MarkerAdjuster::Linearisation> MarkerAdjuster::Linearise() {
  auto linearisation = std::make_unique<Linearisation>();
  linearisation->state = MakeState(model_);
  linearisation->problem = MakeProblem(WithoutLoss(weights_), model_, &linearisation->state);
  std::optional<MarkerCovariance> covariance = Invert(MakeNormalEquations(linearisation->problem));
  if (!covariance) {
    throw DataError(
        "the images leave the shape undetermined: take them from more places, so that every marker "
        "is seen from different sides");
  }
  linearisation->covariance = std::move(*covariance);
  return linearisation;
}

std::vector<MarkerAdjuster::CornerResidual> MarkerAdjuster::EvaluateCorners(const Model& model) {
  MarkerState state = MakeState(model);
  return EvaluateCorners(MakeProblem(WithoutLoss(weights_), model, &state));
}

std::vector<MarkerAdjuster::CornerResidual> MarkerAdjuster::EvaluateCorners(
    const MarkerProblem& problem) {
  std::vector<double> residuals;
  const auto append = [&residuals](const SchurResidual&, const Eigen::VectorXd& of_view,
                                   const std::vector<SchurSystem::RowMajor>&) {
    residuals.insert(residuals.end(), of_view.begin(), of_view.end());
  };
  VELAMAP_CHECK(VisitResiduals(problem.schur, problem.corner_residuals, false, append));
  std::vector<CornerResidual> corners;
  for (std::size_t i = 0; i < problem.corners.size(); ++i) {
    corners.push_back({problem.corners[i].first, problem.corners[i].second,
                       std::hypot(residuals[2 * i], residuals[2 * i + 1])});
  }
  return corners;
}

double MarkerAdjuster::CalibrateRobustly() {
  std::vector<double> squares;
  for (const CornerResidual& corner : EvaluateCorners(model_)) {
    squares.push_back(corner.sigmas * corner.sigmas);
  }
  const double num_residuals = 2.0 * static_cast<double>(squares.size());
  const double num_parameters = 6.0 * static_cast<double>(model_.images.size() - 1) +
                                3.0 * static_cast<double>(model_.points3D.size());
  const double redundancy = std::max(0.2 * num_residuals, num_residuals - num_parameters);
  // The square of a normal residual's length has the median 2 ln 2.
  const double variance =
      Median(std::move(squares)) / (2.0 * std::log(2.0)) * num_residuals / redundancy;
  const double before = weights_.corner_factor;
  weights_.corner_factor = std::max(kMinCornerFactor, before * std::sqrt(variance));
  spdlog::debug("corner sigmas times {:.4f}", weights_.corner_factor);
  return std::abs(weights_.corner_factor / before - 1.0);
}

int MarkerAdjuster::ReviseCorners() {
  const auto key = [](Point3DId point3D_id, const TrackElement& element) {
    return std::make_pair(point3D_id, element.image_id);
  };
  std::set<std::pair<Point3DId, ImageId>> before;
  std::vector<RemovedObservation> removed;
  Model candidate = model_;
  for (const RemovedObservation& observation : summary_.removed) {
    before.insert(key(observation.point3D_id, observation.element));
    if (!Restore(observation, &candidate)) removed.push_back(observation);
  }
  int num_changes = static_cast<int>(before.size() - removed.size());
  for (const CornerResidual& corner : EvaluateCorners(candidate)) {
    if (corner.sigmas <= options_.outlier_sigmas) continue;
    num_changes += before.count(key(corner.point3D_id, corner.element)) > 0 ? -1 : 1;
    removed.push_back({corner.point3D_id, corner.element,
                       ReprojectionErrorPx(candidate, corner.point3D_id, corner.element)});
    RemoveObservation(&candidate, corner.point3D_id, corner.element);
  }
  model_ = std::move(candidate);
  summary_.removed = std::move(removed);
  RemoveUnderconstrainedParts();
  return num_changes;
}

void MarkerAdjuster::RemoveUnderconstrainedParts() {
  RemoveUnderconstrained(options_.min_track_length, &model_, &summary_.removed_images);
  CheckEnough(model_, num_images_before_);
}

}  // namespace velamap
