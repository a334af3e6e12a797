#include "workflows/run/adjustment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "importer/geometry/units.h"
#include "reconstruct/colmap/colmap_runner.h"
#include "reconstruct/colmap/observation_filter.h"
#include "reconstruct/geometry/intrinsics_prior.h"
#include "reconstruct/model/model_io.h"
#include "workflows/run/camera_checks.h"

namespace velamap {
namespace {

// Corners are accurate to a few tenths of a pixel, so a larger error has another cause.
constexpr double kSuspiciousErrorPx = 1.0;

// Gives cameras without distortion parameters ones that are zero, so that they can be refined.
void AddDistortion(Model* model) {
  for (auto& [camera_id, camera] : model->cameras) {
    const Camera distorted = WithDistortionParams(camera);
    if (distorted == camera) continue;
    camera = distorted;
    LogInfo("camera {} has no distortion; it is refined from zero", camera_id);
  }
}

void WarnOfRemovedImages(const std::vector<ImageId>& removed_images) {
  if (removed_images.empty()) return;
  LogWarning("{} images are left out because most of their observations are outliers",
             removed_images.size());
}

BundleAdjustmentSummary RunColmapBackend(const BundleAdjustmentOptions& options,
                                         const std::string& log_path, Model* model) {
  LogInfo("bundle adjustment of {} images and {} points by {}", model->images.size(),
          model->points3D.size(), options.colmap_path);
  BundleAdjustmentSummary summary = AdjustWithColmap(options, log_path, model);
  LogInfo("rounds: {}, outliers removed: {}, mean reprojection error {:.3f} -> {:.3f} px",
          summary.num_rounds, summary.removed.size(), summary.error_before_px.mean,
          summary.error_after_px.mean);
  WarnOfRemovedImages(summary.removed_images);
  return summary;
}

// Returns how many of the observations could not be returned to the model.
int RestoreAll(const std::vector<RemovedObservation>& removed, Model* model) {
  constexpr double kAnyError = std::numeric_limits<double>::infinity();
  return static_cast<int>(
      std::count_if(removed.begin(), removed.end(), [&](const RemovedObservation& observation) {
        return !RestoreObservation(observation, kAnyError, model);
      }));
}

void LogMarkersSummary(const MarkerAdjustmentSummary& summary) {
  const AdjustmentUncertainty& uncertainty = summary.uncertainty;
  LogInfo(
      "iterations: {}, outliers removed: {}, mean reprojection error {:.3f} -> {:.3f} px, scale "
      "sigma {:.3f} %",
      summary.num_iterations, summary.removed.size(), summary.error_before_px.mean,
      summary.error_after_px.mean, 100.0 * uncertainty.relative_scale_sigma);
  LogInfo(
      "sigmas of the corners scaled by {:.2f} to fit the residuals and by {:.2f} for correlated "
      "errors; {:.2f} % of the residuals exceed 4 sigmas",
      std::sqrt(uncertainty.variance_factor), uncertainty.correlation_factor,
      100.0 * uncertainty.share_above_4_sigma);
  const CalibrationEvidence& calibration = uncertainty.calibration;
  // A focal length that the adjustment has refined cannot change any further.
  const std::string focal_change =
      summary.cameras.empty()
          ? fmt::format("; focal length {:+.2f} +- {:.2f} %", 100.0 * calibration.focal_change,
                        100.0 * calibration.focal_sigma)
          : "";
  LogInfo(
      "calibration: {} changes would explain {:.3f} px of the residuals ({:.1f} sigmas{}) and move "
      "the shape by {:.2f} mm ({:.1f} of its sigmas)",
      calibration.num_changes, calibration.systematic_px, SigmasAgainst(calibration), focal_change,
      kMmPerM * calibration.shape_change_m, calibration.shape_change_in_sigmas);
  LogDebug("calibration: focal length explains {:.2f}, distortion {:.2f}", calibration.focal_share,
           calibration.distortion_share);
  if (uncertainty.apparent_inset_sigma_px > 0) {
    LogInfo("apparent inset of the corners {:.3f} +- {:.3f} px", uncertainty.apparent_inset_px,
            uncertainty.apparent_inset_sigma_px);
  }
  if (uncertainty.rolling_shutter_sigma_s > 0) {
    LogInfo("rolling shutter: {:.2f} +- {:.2f} ms from the first row to the last",
            1e3 * uncertainty.rolling_shutter_s, 1e3 * uncertainty.rolling_shutter_sigma_s);
  }
  for (const std::string& warning : summary.warnings) LogWarning(warning);
  WarnOfRemovedImages(summary.removed_images);
  for (const auto& [camera_id, camera] : summary.cameras) {
    LogInfo("camera found: {}", DescribeCamera(camera));
  }
}

AdjustmentResult RunMarkersBackend(const MarkerAdjustmentOptions& options, const Layout& layout,
                                   const CornerErrors& corner_errors, Model* model) {
  LogInfo("marker-aware bundle adjustment of {} images and {} points", model->images.size(),
          model->points3D.size());
  MarkerAdjustmentSummary summary;
  try {
    summary = AdjustWithMarkers(options, layout, corner_errors, model);
  } catch (const DataError& error) {
    if (!options.find_camera) throw;
    throw DataError(error.what() + std::string(kOrWithCalibration));
  }
  LogMarkersSummary(summary);
  return {summary.error_before_px,
          summary.error_after_px,
          static_cast<int>(summary.removed.size()),
          std::move(summary.uncertainty),
          std::move(summary.cameras),
          {}};
}

// Throws DataError if all points are in one place and determine no shape.
void CheckExtent(const Model& model) {
  constexpr double kLeastExtent = 1e-9;  // of the points' distance from the origin
  Eigen::AlignedBox3d box;
  for (const auto& [point3D_id, point] : model.points3D) box.extend(point.x_in_world);
  if (box.isEmpty()) return;  // the adjustment says that there are none
  const double distance = std::max(box.min().norm(), box.max().norm());
  if (box.diagonal().norm() > kLeastExtent * distance) return;
  throw DataError(
      fmt::format("all {} points of the model lie at one place; there is no shape to adjust",
                  model.points3D.size()));
}

}  // namespace

void AdjustmentOptions::Complete(int num_threads) {
  colmap.Check();
  markers.refine_focal_length = colmap.refine_focal_length;
  markers.refine_principal_point = colmap.refine_principal_point;
  markers.refine_extra_params = colmap.refine_extra_params;
  markers.max_num_iterations = colmap.max_num_iterations;
  markers.min_track_length = colmap.min_track_length;
  markers.max_mean_error_px = colmap.max_mean_error_px;
  markers.num_threads = num_threads;
  markers.Check();
}

void CheckColmap(const std::string& colmap_path) {
  if (!ColmapHasOption(colmap_path, "bundle_adjuster", "input_path")) {
    throw ExternalToolError(fmt::format(
        "{0}: not COLMAP's program ({0} bundle_adjuster -h does not list --input_path); "
        "name it with --colmap_path",
        colmap_path));
  }
}

AdjustmentResult AdjustModel(const AdjustmentOptions& options, const Layout& layout,
                             const CornerErrors& corner_errors, const std::string& log_path,
                             Model* model) {
  CheckExtent(*model);
  AdjustmentResult result;
  std::optional<Model> seed;  // of the marker-aware adjustment
  if (options.colmap.refine_extra_params) AddDistortion(model);
  if (options.UsesColmap()) {
    BundleAdjustmentOptions colmap = options.colmap;
    if (options.UsesMarkers()) {
      // The marker-aware adjustment has priors, whose mean must be the calibration.
      colmap.refine_focal_length = colmap.refine_principal_point = colmap.refine_extra_params =
          false;
    }
    const BundleAdjustmentSummary summary = RunColmapBackend(colmap, log_path, model);
    result.error_before_px = summary.error_before_px;
    result.error_after_px = summary.error_after_px;
    // The marker-aware adjustment judges all corners anew: it knows their sigmas and what moves.
    result.num_removed = options.UsesMarkers() ? RestoreAll(summary.removed, model)
                                               : static_cast<int>(summary.removed.size());
  }
  if (options.UsesMarkers()) {
    const Statistics before_px = result.error_before_px;
    const int num_removed = result.num_removed;
    seed = *model;
    result = RunMarkersBackend(options.markers, layout, corner_errors, model);
    if (!options.markers.find_camera) {
      WarnOfFisheye(options.markers, layout, corner_errors, *seed, *model, result.uncertainty);
    }
    if (options.UsesColmap()) result.error_before_px = before_px;
    result.num_removed += num_removed;
  }
  result.steadiness =
      CheckSteadiness(options.markers, layout, corner_errors, seed ? &*seed : nullptr, *model);
  if (result.error_after_px.mean > kSuspiciousErrorPx) {
    LogWarning(
        "a mean reprojection error of {:.2f} px is more than the noise of corners explains: does "
        "the calibration belong to these images, and did the surface keep its shape? Do not trust "
        "the result",
        result.error_after_px.mean);
  }
  return result;
}

void WriteAdjustedModel(const Model& model, const AdjustmentResult& result,
                        const std::string& path) {
  WriteModel(model, path, ModelFormat::kBinaryAndText, [&](const std::string& folder) {
    if (result.uncertainty) WriteUncertainty(*result.uncertainty, model, folder);
  });
}

}  // namespace velamap
