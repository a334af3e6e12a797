#include <iostream>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "importer/base/log.h"
#include "importer/database/colmap_database.h"
#include "reconstruct/camera/lens_bend_correction.h"
#include "reconstruct/model/model_io.h"
#include "workflows/commands/commands.h"
#include "workflows/options/option_effects.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/adjustment.h"
#include "workflows/run/pipeline.h"
#include "workflows/run/stage_times.h"
#include "workflows/run/summary.h"

namespace velamap {
namespace {

struct BundleAdjusterCommandOptions : CommandOptions {
  AdjustmentOptions adjustment;
};

CommandSyntax Declare(BundleAdjusterCommandOptions* options) {
  options->adjustment.backend = AdjustmentBackend::kColmap;  // needs no more than a model
  PathOptions* paths = &options->paths;
  return {"bundle_adjuster",
          "refines all cameras and points jointly (bundle adjustment)",
          "--input_path sparse/seed --output_path sparse/0",
          {{"Input and output",
            {ModelInputOption(paths),
             Required(PathOption("output_path", PathUse::kWritesFolder, &paths->output_path,
                                 "folder of the adjusted model")),
             ColmapLogOption(paths), BackendOption(&options->adjustment.backend),
             PresetOption(&options->preset),
             Common(PathOption(
                 "database_path", PathUse::kReadsFile, &paths->database_path,
                 "database of the model's images, which gives the sigma and motion of each "
                 "corner; for --backend markers or both"))}},
           DescribeOptions(&options->markers, false),
           DescribeOptions(&options->adjustment.colmap),
           DescribeOptions(&options->adjustment.markers),
           DescribeOptions(&options->general)},
          &options->preset};
}

void Validate(BundleAdjusterCommandOptions* options) {
  LogPreset(options->preset);
  RefuseOptionsOfOtherBackend(options->typed, options->adjustment.backend);
  if (!options->adjustment.UsesMarkers()) {
    RefuseOptionsWithoutEffect(
        options->typed, {"database_path"},
        "--backend colmap adjusts without the corners' sigmas (--backend both or "
        "markers would use it)");
    WarnOfOptionsWithoutEffect(options->typed, {"layout_path", "marker_length"},
                               "--backend colmap does not know the markers (--backend both or "
                               "markers would use it)");
  }
  options->adjustment.Complete(options->general.num_threads);
}

// Takes the image points of the model from the images of the database, because an earlier
// adjustment may have removed a rolling shutter from them.
void RestoreKeypoints(const std::vector<DatabaseImage>& images, const PathOptions& paths,
                      Model* model) {
  std::map<ImageId, const FrameDetections*> detections;
  for (const DatabaseImage& image : images) detections[image.image_id] = &image.detections;
  for (ModelImage& image : model->images) {
    const auto found = detections.find(image.image_id);
    if (found == detections.end() || found->second->image_name != image.name ||
        image.points2D.size() != kNumCorners * found->second->markers.size()) {
      throw InputError(fmt::format(
          "{}: image {} is not the one of {}: give the database that the model was made from",
          paths.database_path, image.name, paths.input_path));
    }
    for (std::size_t i = 0; i < image.points2D.size(); ++i) {
      image.points2D[i].x_in_image_px =
          found->second->markers[i / kNumCorners].corners_in_image_px[i % kNumCorners];
    }
  }
}

// A camera that was estimated instead of calibrated is refined, so that the sigmas include its
// uncertainty.
CornerErrors LoadCorners(const BundleAdjusterCommandOptions& options, const Layout& layout,
                         AdjustmentOptions* adjustment, Model* model) {
  if (options.paths.database_path.empty() || !options.adjustment.UsesMarkers()) {
    return CornerErrorsOf({});
  }
  const ColmapDatabase database(options.paths.database_path, ColmapDatabase::Mode::kReadOnly);
  CheckLayoutOfDatabase(database, options.paths.database_path, layout);
  std::vector<DatabaseImage> images = database.ReadImages();
  if (!database.HasCalibration()) CorrectForLensBend(model->cameras, &images);
  RestoreKeypoints(images, options.paths, model);
  if (!database.HasCalibration() && !adjustment->markers.find_camera) {
    RefuseFixedCameraWithoutCalibration(options.typed, adjustment->markers,
                                        options.paths.database_path + " was made without");
    LogInfo("{}: made without a calibration; the camera is refined", options.paths.database_path);
    adjustment->markers.find_camera = true;
  }
  return CornerErrorsOf(images, database.ReadFormation());
}

void RefuseOptionsWithoutData(const BundleAdjusterCommandOptions& options,
                              const AdjustmentOptions& adjustment,
                              const CornerErrors& corner_errors) {
  if (adjustment.markers.find_camera) RefuseOptionsOfKnownCamera(options.typed);
  if (corner_errors.motions.empty()) {
    RefuseOptionsWithoutEffect(
        options.typed,
        {"MarkerAdjustment.rolling_shutter", "MarkerAdjustment.estimate_rolling_shutter"},
        "no --database_path with the frames of a video says how fast the corners move");
  }
}

void Print(const AdjustmentResult& result, const std::string& model_path, std::ostream& out) {
  out << fmt::format("reprojection_error_before_px: {}\n", ErrorText(result.error_before_px));
  out << fmt::format("reprojection_error_px: {}\n", ErrorText(result.error_after_px));
  out << fmt::format("outliers_removed: {} of {} observations\n", result.num_removed,
                     result.error_before_px.count);
  if (result.uncertainty) {
    out << fmt::format("scale_sigma: {:.4f} %\n", 100.0 * result.uncertainty->relative_scale_sigma);
    out << fmt::format("corners_above_4_sigma: {:.3f} %\n",
                       100.0 * result.uncertainty->share_above_4_sigma);
    PrintRollingShutter(*result.uncertainty, out);
  }
  for (const auto& [camera_id, camera] : result.cameras) {
    out << fmt::format("camera_found: {}\n", DescribeCamera(camera));
  }
  out << fmt::format("model_path: {}\n", model_path);
}

void Run(const BundleAdjusterCommandOptions& options) {
  StageClock clock;
  Layout layout;  // COLMAP's adjustment needs none
  if (options.adjustment.UsesMarkers()) layout = LoadLayout(options.markers, false);
  Model model = ReadModel(options.paths.input_path);
  AdjustmentOptions adjustment = options.adjustment;
  const CornerErrors corner_errors = LoadCorners(options, layout, &adjustment, &model);
  RefuseOptionsWithoutData(options, adjustment, corner_errors);
  const AdjustmentResult result =
      AdjustModel(adjustment, layout, corner_errors, options.paths.log_path, &model);
  clock.End("adjust", static_cast<int>(model.images.size()));
  WriteAdjustedModel(model, result, options.paths.output_path);
  clock.End("export");
  LogStageTimes(clock);
  Print(result, options.paths.output_path, std::cout);
}

}  // namespace

Command BundleAdjuster() {
  return MakeCommand<BundleAdjusterCommandOptions>(Declare, Validate, Run);
}

}  // namespace velamap
