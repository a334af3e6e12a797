#include "workflows/run/pipeline.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/numbers.h"
#include "importer/database/colmap_database.h"
#include "reconstruct/colmap/colmap_runner.h"
#include "reconstruct/evidence/unnamed_markers.h"
#include "reconstruct/geometry/intrinsics_prior.h"
#include "reconstruct/model/model_io.h"
#include "reconstruct/seed_model.h"
#include "reconstruct/thesis/frame_selection.h"
#include "workflows/run/camera_checks.h"
#include "workflows/run/progress.h"
#include "workflows/run/summary.h"

namespace velamap {
namespace {

// Corners are accurate to a few tenths of a pixel, so a larger error has another cause.
constexpr double kSuspiciousErrorPx = 1.0;

std::vector<LeftOutImage> FindLeftOut(const SeedResult& seed) {
  std::set<std::string> used;
  for (const ModelImage& image : seed.model.images) used.insert(image.name);
  std::map<std::string, std::string> reasons;
  for (const RegisteredFrame& frame : seed.registration.frames) {
    reasons[frame.image_name] =
        frame.reason.empty() ? "fewer than two of its markers stay" : frame.reason;
  }
  std::vector<LeftOutImage> left_out;
  for (const std::string& name : seed.image_names) {
    if (used.count(name) > 0) continue;
    const auto it = reasons.find(name);
    left_out.push_back({name, it == reasons.end() ? "no marker found" : it->second});
  }
  return left_out;
}

// Nothing for photographs.
std::optional<ReportClip> ClipOf(const std::vector<DatabaseImage>& images) {
  std::map<int, double> time_of_s;  // by frame number
  for (const DatabaseImage& image : images) {
    const FrameDetections& frame = image.detections;
    if (frame.frame_number && frame.time_s) time_of_s[*frame.frame_number] = *frame.time_s;
  }
  if (time_of_s.size() < 2) return std::nullopt;
  const auto [first, first_s] = *time_of_s.begin();
  const auto [last, last_s] = *time_of_s.rbegin();
  if (!(last_s > first_s)) return std::nullopt;
  const double frames_per_s = (last - first) / (last_s - first_s);
  return ReportClip{frames_per_s, last_s - first_s + 1.0 / frames_per_s};
}

void LogPriorShapeAgreement(const PriorShapeAgreement& agreement) {
  if (agreement.num_known == 0) {
    spdlog::warn(
        "--prior_shape_path: not used, because no frame shows four of its markers; are its ids "
        "those of the dictionary and the layout?");
    return;
  }
  spdlog::info("{} of the {} markers found that the prior shape holds are where it has them",
               agreement.num_agreeing, agreement.num_known);
  if (2 * agreement.num_agreeing < agreement.num_known) {
    spdlog::warn(
        "--prior_shape_path: the prior shape does not fit these images and was of little use; is "
        "it of this surface, and does the calibration belong to these images?");
  }
}

void LogSeed(const SeedResult& seed) {
  const Registration& registration = seed.registration;
  spdlog::info("central image {}: {}", registration.central_image_name,
               registration.central_reason);
  for (const std::string& note : registration.notes) spdlog::info(note);
  spdlog::info("{} of {} images registered, {} markers", seed.model.images.size(),
               seed.image_names.size(), registration.shape.size());
  if (!seed.left_out.empty()) spdlog::info("images left out: {}", LeftOutText(seed.left_out));
  for (const DroppedMarker& marker : registration.dropped_markers) {
    if (marker.is_false) {
      spdlog::warn("marker {} left out: {}", marker.marker_id, marker.reason);
    } else {
      spdlog::debug("marker {} left out: {}", marker.marker_id, marker.reason);
    }
  }
}

// Gives cameras without distortion one of zero, so that it can be refined.
void AddDistortion(Model* model) {
  for (auto& [camera_id, camera] : model->cameras) {
    const Camera distorted = WithDistortionParams(camera);
    if (distorted == camera) continue;
    camera = distorted;
    spdlog::info("camera {} has no distortion; it is refined from zero", camera_id);
  }
}

void WarnOfRemovedImages(const std::vector<ImageId>& removed_images) {
  if (removed_images.empty()) return;
  spdlog::warn("{} images are left out because most of their observations are outliers",
               removed_images.size());
}

AdjustmentResult RunColmapBackend(const BundleAdjustmentOptions& options,
                                  const std::string& log_path, Model* model) {
  spdlog::info("bundle adjustment of {} images and {} points by {}", model->images.size(),
               model->points3D.size(), options.colmap_path);
  const BundleAdjustmentSummary summary = AdjustWithColmap(options, log_path, model);
  spdlog::info("{} rounds, {} outliers removed, mean reprojection error {:.3f} -> {:.3f} px",
               summary.num_rounds, summary.removed.size(), summary.error_before_px.mean,
               summary.error_after_px.mean);
  WarnOfRemovedImages(summary.removed_images);
  return {summary.error_before_px,
          summary.error_after_px,
          static_cast<int>(summary.removed.size()),
          std::nullopt,
          {}};
}

AdjustmentResult RunMarkersBackend(const MarkerAdjustmentOptions& options, const Layout& layout,
                                   const CornerErrors& corner_errors, Model* model) {
  spdlog::info("marker-aware bundle adjustment of {} images and {} points", model->images.size(),
               model->points3D.size());
  MarkerAdjustmentSummary summary = AdjustWithMarkers(options, layout, corner_errors, model);
  const AdjustmentUncertainty& uncertainty = summary.uncertainty;
  spdlog::info(
      "{} iterations, {} outliers removed, mean reprojection error {:.3f} -> {:.3f} px, scale "
      "sigma {:.3f} %",
      summary.num_iterations, summary.removed.size(), summary.error_before_px.mean,
      summary.error_after_px.mean, 100.0 * uncertainty.relative_scale_sigma);
  spdlog::info(
      "sigmas of the corners scaled by {:.2f} to fit the residuals and by {:.2f} for correlated "
      "errors; {:.2f} % of the residuals exceed 4 sigmas",
      std::sqrt(uncertainty.variance_factor), uncertainty.correlation_factor,
      100.0 * uncertainty.share_above_4_sigma);
  const CalibrationEvidence& calibration = uncertainty.calibration;
  spdlog::info(
      "calibration: {} changes would explain {:.3f} px of the residuals ({:.1f} sigmas; focal "
      "length {:+.2f} +- {:.2f} %) and move the shape by {:.2f} mm ({:.1f} of its sigmas)",
      calibration.num_changes, calibration.systematic_px, SigmasOff(calibration),
      100.0 * calibration.focal_change, 100.0 * calibration.focal_sigma,
      1e3 * calibration.shape_change_m, calibration.shape_change_in_sigmas);
  spdlog::debug("calibration: focal length explains {:.2f}, distortion {:.2f}",
                calibration.focal_share, calibration.distortion_share);
  if (uncertainty.apparent_inset_sigma_px > 0) {
    spdlog::info("apparent inset of the corners {:.3f} +- {:.3f} px", uncertainty.apparent_inset_px,
                 uncertainty.apparent_inset_sigma_px);
  }
  if (uncertainty.rolling_shutter_sigma_s > 0) {
    spdlog::info("rolling shutter: {:.2f} +- {:.2f} ms from the first row to the last",
                 1e3 * uncertainty.rolling_shutter_s, 1e3 * uncertainty.rolling_shutter_sigma_s);
  }
  for (const std::string& warning : summary.warnings) spdlog::warn(warning);
  WarnOfRemovedImages(summary.removed_images);
  for (const auto& [camera_id, camera] : summary.cameras) {
    spdlog::info("camera found: {}", DescribeCamera(camera));
  }
  return {summary.error_before_px, summary.error_after_px, static_cast<int>(summary.removed.size()),
          std::move(summary.uncertainty), std::move(summary.cameras)};
}

// Throws DataError for points that determine no shape: all in one place.
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

VideoOptions NarrowToReach(const VideoOptions& video, const RegistrationOptions& registration) {
  int number = 0;
  if (!ParseNumber(registration.central_frame, &number) || number < 0 ||
      registration.frame_order == FrameOrder::kUnordered ||
      registration.method == RegistrationMethod::kGlobal) {
    return video;
  }
  const auto [first, last] = ReachableFrames(
      number,
      {registration.thesis.num_frames, registration.thesis.skip, registration.thesis.neighborhood});
  VideoOptions narrowed = video;
  // Whole steps from the first frame, so that the same frames are read.
  const int skipped = std::max(0, first - video.first_frame);
  narrowed.first_frame += skipped / video.frame_step * video.frame_step;
  narrowed.last_frame = video.last_frame < 0 ? last : std::min(video.last_frame, last);
  return narrowed;
}

ImportReport ImportImages(const MarkerImporterOptions& options) {
  Progress progress("detecting markers");
  const ImportReport report =
      ImportMarkers(options, [&progress](int done, int total, const std::string& message) {
        progress.Update(done, total, message);
      });
  ClearProgressLine();
  spdlog::info("{} images added, {} were in the database before, {} markers found",
               report.num_images_added, report.num_images_present, report.num_markers);
  if (report.num_fallbacks > 0) {
    spdlog::info(
        "the corners of {} markers come from cv::cornerSubPix: their edges were not fitted",
        report.num_fallbacks);
  }
  if (!options.prior_shape.empty() && report.num_frames_read > 0)
    LogPriorShapeAgreement(report.prior_shape);
  if (!report.ids_not_in_layout.empty()) {
    spdlog::info("ids that the layout does not name, or that were misread: {}",
                 fmt::join(report.ids_not_in_layout, " "));
  }
  return report;
}

SeedResult RegisterDatabase(const std::string& database_path, const Layout& layout,
                            const RegistrationOptions& options,
                            const MarkerAdjustmentOptions& adjustment) {
  const ColmapDatabase database(database_path, ColmapDatabase::Mode::kReadOnly);
  const std::vector<DatabaseImage> images = database.ReadImages();
  std::map<CameraId, Camera> cameras = database.ReadCameras();
  SeedResult seed;
  seed.corner_errors = CornerErrorsOf(images, database.ReadFormation());
  if (!database.HasCalibration()) {
    cameras = FindUnknownCameras(images, cameras, layout, seed.corner_errors, options, adjustment);
    seed.found_cameras = true;
  }
  for (const auto& [name, image_id] : database.ReadImageIdsByName()) {
    seed.image_names.push_back(name);
  }
  spdlog::info("registering {} images", images.size());
  seed.registration = RegisterFrames(images, cameras, layout, options);
  seed.model = MakeSeedModel(seed.registration, images, cameras);
  seed.left_out = FindLeftOut(seed);
  std::set<int> ids;
  for (const DatabaseImage& image : images) {
    for (const MarkerDetection& marker : image.detections.markers) ids.insert(marker.marker_id);
  }
  seed.num_ids_found = static_cast<int>(ids.size());
  seed.clip = ClipOf(images);
  LogSeed(seed);
  const std::vector<int> unnamed = FindUnnamedMarkers(images, seed.model);
  if (!unnamed.empty()) {
    spdlog::warn("markers left out because the layout does not name them: {}",
                 fmt::join(unnamed, " "));
  }
  return seed;
}

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
    result = RunColmapBackend(colmap, log_path, model);
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
  CheckSteadiness(options.markers, layout, corner_errors, seed ? &*seed : nullptr, *model);
  if (result.error_after_px.mean > kSuspiciousErrorPx) {
    spdlog::warn(
        "a mean reprojection error of {:.2f} px is more than the noise of corners explains: does "
        "the calibration belong to these images, and did the surface keep its shape? Do not trust "
        "the result",
        result.error_after_px.mean);
  }
  return result;
}

void WarnOfMissingSections(const SectionReport& sections) {
  for (const MissingSection& missing : sections.missing) {
    // What the layout alone decides is said, but is no reason to check this clip.
    spdlog::log(missing.is_by_layout ? spdlog::level::info : spdlog::level::warn,
                "no section {} of {}: {}", missing.name, missing.part, missing.reason);
  }
}

void WriteAdjustedModel(const Model& model, const AdjustmentResult& result,
                        const std::string& path) {
  WriteModel(model, path, ModelFormat::kBinaryAndText, [&result](const std::string& folder) {
    if (result.uncertainty) WriteUncertainty(*result.uncertainty, folder);
  });
}

}  // namespace velamap
