#include <iostream>

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <fmt/ranges.h>

#include "importer/camera/calibration.h"
#include "workflows/commands/commands.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/pipeline.h"
#include "workflows/run/stage_times.h"

namespace velamap {
namespace {

struct Options {
  PathOptions paths;
  MarkerOptions markers;
  GeneralOptions general;
  MarkerImporterOptions importer;
};

CommandSyntax Declare(Options* options) {
  PathOptions* paths = &options->paths;
  return {"marker_importer",
          "finds the markers in images or a video and writes them into a COLMAP database; images "
          "that the database already holds are passed over",
          "--image_path photos --camera_path camera.yml --layout_path layout.yml \\\n"
          "    --database_path database.db",
          {{"Input and output",
            {ImagePathOption(paths),
             CameraPathOption(paths),
             PriorShapePathOption(paths),
             DatabasePathOption(paths, "COLMAP database, made new or added to"),
             {"frame_output_path", &paths->frame_output_path, "path",
              "folder for the frames of a video that hold markers, as JPEG; left out: none are "
              "written"}}},
           MarkerGroup(&options->markers, true),
           ArucoDetectionGroup(&options->importer.detection),
           VideoGroup(&options->importer.video),
           GeneralGroup(&options->general)}};
}

void Validate(Options* options) {
  ApplyGeneralOptions(options->general);
  MarkerImporterOptions& importer = options->importer;
  importer.detection.Check();
  importer.video.Check();
  importer.layout = LoadLayout(options->markers, true);
  importer.camera = ReadCalibration(options->paths.camera_path);
  importer.camera_path = options->paths.camera_path;
  importer.prior_shape = LoadPriorShape(options->paths.prior_shape_path);
  importer.image_path = options->paths.image_path;
  importer.database_path = options->paths.database_path;
  importer.frame_output_path = options->paths.frame_output_path;
  importer.num_threads = options->general.num_threads;
}

void Print(const ImportReport& report, const PathOptions& paths, std::ostream& out) {
  fmt::print(out, "images_added: {}\n", report.num_images_added);
  fmt::print(out, "images_present: {}\n", report.num_images_present);
  fmt::print(out, "images_without_markers: {}\n", report.num_images_without_markers);
  fmt::print(out, "images_skipped: {}\n", report.skipped.size());
  fmt::print(out, "markers: {}\n", report.num_markers);
  fmt::print(out, "markers_rejected: {}\n", report.num_rejected);
  fmt::print(out, "markers_without_corner_fit: {}\n", report.num_fallbacks);
  fmt::print(out, "ids_not_in_layout: {}\n",
             report.ids_not_in_layout.empty()
                 ? "none"
                 : fmt::format("{}", fmt::join(report.ids_not_in_layout, " ")));
  if (!paths.prior_shape_path.empty()) {
    fmt::print(out, "markers_of_prior_shape: {}\n", report.prior_shape.num_known);
    fmt::print(out, "markers_agreeing_with_prior_shape: {}\n", report.prior_shape.num_agreeing);
  }
  fmt::print(out, "pairs_with_matches: {}\n", report.num_pairs);
  fmt::print(out, "database_path: {}\n", paths.database_path);
}

}  // namespace

void RunMarkerImporter(const Arguments& arguments) {
  Options options;
  if (!ParseOrPrintHelp(Declare(&options), arguments)) return;
  Validate(&options);
  StageClock clock;
  const ImportReport report = ImportImages(options.importer);
  clock.EndImport(report.times, report.num_frames_read);
  LogStageTimes(clock);
  Print(report, options.paths, std::cout);
}

}  // namespace velamap
