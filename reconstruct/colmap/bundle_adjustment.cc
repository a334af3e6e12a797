#include "reconstruct/colmap/bundle_adjustment.h"

#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "reconstruct/colmap/colmap_runner.h"
#include "reconstruct/colmap/observation_filter.h"
#include "reconstruct/geometry/intrinsics_prior.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/model_io.h"
#include "reconstruct/model/reprojection.h"

namespace velamap {
namespace {

std::vector<std::string> BundleAdjusterArguments(const BundleAdjustmentOptions& options,
                                                 const std::string& input_path,
                                                 const std::string& output_path) {
  std::vector<std::string> arguments = {"bundle_adjuster", "--input_path", input_path,
                                        "--output_path", output_path};
  const auto add = [&](const std::string& name, const std::string& value) {
    // COLMAP 4 changed the prefix of the solver's options.
    for (const char* prefix : {"BundleAdjustment.", "BundleAdjustmentCeres."}) {
      if (ColmapHasOption(options.colmap_path, "bundle_adjuster", prefix + name)) {
        arguments.insert(arguments.end(), {"--" + (prefix + name), value});
        return;
      }
    }
    LogWarning("{} bundle_adjuster has no option for {}: its default is used", options.colmap_path,
               name);
  };
  add("refine_focal_length", options.refine_focal_length ? "1" : "0");
  add("refine_principal_point", options.refine_principal_point ? "1" : "0");
  add("refine_extra_params", options.refine_extra_params ? "1" : "0");
  add("max_num_iterations", std::to_string(options.max_num_iterations));
  add("function_tolerance", fmt::format("{}", options.function_tolerance));
  return arguments;
}

[[noreturn]] void ThrowImplausible(const std::string& what, const std::string& log_path) {
  throw ExternalToolError(fmt::format(
      "COLMAP's bundle_adjuster gave an implausible result: {}; log: {}", what, log_path));
}

// Checks that COLMAP's result has all images, points, tracks and cameras of its input `before`,
// because its exit status may be 0 although it failed. Throws InputError if the distortion cannot
// be refined as the options ask.
void CheckStructure(const BundleAdjustmentOptions& options, const Model& before, const Model& after,
                    const std::string& log_path) {
  const auto fail = [&log_path](const std::string& what) { ThrowImplausible(what, log_path); };
  const bool refines_cameras =
      options.refine_focal_length || options.refine_principal_point || options.refine_extra_params;
  if (after.images.size() != before.images.size()) {
    fail(fmt::format("{} of {} images came back", after.images.size(), before.images.size()));
  }
  if (after.points3D.size() != before.points3D.size()) {
    fail(fmt::format("{} of {} points came back", after.points3D.size(), before.points3D.size()));
  }
  for (const ModelImage& image : before.images) {
    if (after.FindImage(image.image_id) == nullptr) {
      fail(fmt::format("image {} is lost", image.image_id));
    }
  }
  for (const auto& [point3D_id, point] : before.points3D) {
    const auto it = after.points3D.find(point3D_id);
    if (it == after.points3D.end() || it->second.track.size() != point.track.size()) {
      fail(fmt::format("point {} or some of its observations are lost", point3D_id));
    }
  }
  for (const auto& [camera_id, camera] : before.cameras) {
    const auto it = after.cameras.find(camera_id);
    if (it == after.cameras.end() || it->second.model != camera.model) {
      fail(fmt::format("camera {} is lost", camera_id));
    }
    if (refines_cameras ? !(MeanFocalLength(it->second) > 0) : !(it->second == camera)) {
      fail(fmt::format("camera {} has implausible parameters", camera_id));
    }
    if (refines_cameras && HasMonotonicDistortion(camera) && !HasMonotonicDistortion(it->second)) {
      if (options.refine_extra_params) ThrowFoldedDistortion(camera_id);
      fail(fmt::format("the refined distortion of camera {} folds over inside the image",
                       camera_id));
    }
  }
}

// RMS error without points behind their cameras, which ReviseObservations() removes.
double RmsError(const Model& model) {
  std::vector<double> errors_px;
  for (const ObservationError& error : ComputeReprojectionErrors(model)) {
    if (std::isfinite(error.error_px)) errors_px.push_back(error.error_px);
  }
  return ComputeStatistics(std::move(errors_px)).rms;
}

// Copies poses, points and cameras of COLMAP's result. The order of images, names and colours stay
// those of `model`.
void CopyGeometry(const Model& result, Model* model) {
  model->cameras = result.cameras;
  for (ModelImage& image : model->images) {
    image.cam_from_world = result.FindImage(image.image_id)->cam_from_world;
  }
  for (auto& [point3D_id, point] : model->points3D) {
    point.x_in_world = result.points3D.at(point3D_id).x_in_world;
  }
  // Changes nothing if COLMAP has held the pose of the first image, which not all versions may do.
  MoveToFirstCamera(model);
}

Model ReadResult(const std::string& path, const std::string& log_path) {
  try {
    return ReadModel(path);
  } catch (const InputError& error) {
    ThrowImplausible(error.what(), log_path);
  }
}

void AdjustOnce(const BundleAdjustmentOptions& options, const std::string& log_path, Model* model) {
  const TemporaryFolder scratch;
  const std::string input_path = scratch.path() / "in", output_path = scratch.path() / "out";
  CreateFolders(output_path);
  OrderForGauge(model->images.front().image_id, model);
  WriteModel(*model, input_path, ModelFormat::kBinary);
  RunColmap(options.colmap_path, BundleAdjusterArguments(options, input_path, output_path),
            log_path,
            {std::chrono::duration<double, std::ratio<60>>(options.time_limit_min),
             OptionName(&BundleAdjustmentOptions::time_limit_min)});

  const Model result = ReadResult(output_path, log_path);
  CheckStructure(options, *model, result, log_path);
  const double rms_before_px = RmsError(*model);
  CopyGeometry(result, model);
  const double rms_after_px = RmsError(*model);
  constexpr double kRounding = 1e-6;
  if (!(rms_after_px <= (1.0 + kRounding) * rms_before_px + kRounding)) {
    ThrowImplausible(fmt::format("the RMS reprojection error grew from {:.6f} to {:.6f} px",
                                 rms_before_px, rms_after_px),
                     log_path);
  }
}

// COLMAP frees all distortion parameters of a camera, without a prior.
void CheckRefinableDistortion(const BundleAdjustmentOptions& options, const Model& model) {
  if (!options.refine_extra_params) return;
  for (const auto& [camera_id, camera] : model.cameras) {
    if (!HasUnspecifiedDistortion(camera)) continue;
    throw InputError(
        fmt::format("{} 1: COLMAP would also free the parameters of camera {} ({}) that are zero "
                    "in the calibration, and they would diverge; use --backend markers or both, "
                    "which keeps them at zero",
                    OptionName(&BundleAdjustmentOptions::refine_extra_params), camera_id,
                    CameraModelName(camera.model)));
  }
}

}  // namespace

BundleAdjustmentSummary AdjustWithColmap(const BundleAdjustmentOptions& options,
                                         const std::string& log_path, Model* model) {
  options.Check();
  CheckModel(*model);
  CheckRefinableDistortion(options, *model);
  const std::size_t num_images = model->images.size();
  Model adjusted = *model;
  BundleAdjustmentSummary summary;
  summary.error_before_px = SummarizeReprojectionErrors(adjusted);
  if (options.remove_outliers) RemoveSeedOutliers(options, &adjusted, &summary.removed);
  while (true) {
    RemoveUnderconstrained(options.min_track_length, &adjusted, &summary.removed_images);
    CheckEnough(adjusted, num_images, summary.removed.size());
    AdjustOnce(options, log_path, &adjusted);
    ++summary.num_rounds;
    if (!options.remove_outliers || summary.num_rounds == options.max_num_rounds) break;
    const int num_changes = ReviseObservations(options, &adjusted, &summary.removed);
    LogDebug("round {}: {} observations removed or restored", summary.num_rounds, num_changes);
    if (num_changes == 0) break;
  }
  UpdatePointErrors(&adjusted);
  summary.error_after_px = SummarizeReprojectionErrors(adjusted);
  CheckMeanError(summary.error_after_px.mean, options.max_mean_error_px, true);
  *model = std::move(adjusted);
  return summary;
}

}  // namespace velamap
