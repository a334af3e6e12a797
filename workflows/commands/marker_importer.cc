#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <fmt/ranges.h>

#include "workflows/commands/commands.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/pipeline.h"
#include "workflows/run/stage_times.h"

namespace velamap {
namespace {

struct Options : CommandOptions {
  MarkerImporterOptions importer;
};

CommandSyntax Declare(Options* options) {
  PathOptions* paths = &options->paths;
  return {"marker_importer",
          "finds the markers in images or a video and writes them into a COLMAP database",
          "--image_path photos --camera_path camera.yml --layout_path layout.yml \\\n"
          "    --database_path database.db",
          {{"Input and output",
            {ImagePathOption(paths), CameraPathOption(paths), PriorShapePathOption(paths),
             DatabasePathOption(
                 PathUse::kWritesFile, paths,
                 "COLMAP database, new or to be added to; images that it holds are skipped"),
             PathOption("frame_output_path", PathUse::kAddsToFolder, &paths->frame_output_path,
                        "folder for the frames of a video that hold markers, as JPEG; left out: "
                        "none are written"),
             ImportAnewOption(&options->importer), PresetOption(&options->preset)}},
           DescribeOptions(&options->markers, true),
           DescribeOptions(&options->importer.detection),
           DescribeOptions(&options->importer.video),
           DescribeOptions(&options->general)},
          &options->preset};
}

void Validate(Options* options) {
  LogPreset(options->preset);
  MarkerImporterOptions& importer = options->importer;
  CompleteImporter(*options, &importer);
  importer.database_path = options->paths.database_path;
  importer.frame_output_path = options->paths.frame_output_path;
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

void Run(const Options& options) {
  StageClock clock;
  const ImportReport report = ImportImages(options.importer);
  clock.EndImport(report.times, report.num_frames_read);
  LogStageTimes(clock);
  Print(report, options.paths, std::cout);
}

}  // namespace

Command MarkerImporter() {
  return MakeCommand(std::make_shared<Options>(), Declare, Validate, Run);
}

}  // namespace velamap
