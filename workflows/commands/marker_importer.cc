#include <iostream>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importer/base/error.h"
#include "importer/base/numbers.h"
#include "workflows/commands/commands.h"
#include "workflows/options/option_effects.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/pipeline.h"
#include "workflows/run/stage_times.h"

namespace velamap {
namespace {

struct MarkerImporterCommandOptions : CommandOptions {
  MarkerImporterOptions importer;
};

// "2/5".
VideoPart ParsePart(const std::string& text, const std::string& option) {
  VideoPart part;
  const std::string_view all = text;
  const std::size_t slash = all.find('/');
  const bool is_part = slash != std::string_view::npos &&
                       ParseNumber(all.substr(0, slash), &part.number) &&
                       ParseNumber(all.substr(slash + 1), &part.count);
  if (is_part && part.number >= 1 && part.number <= part.count && part.count <= kMaxNumParts) {
    return part;
  }
  throw InputError(
      fmt::format("{}: '{}' is not a part; give 2/5 for the second of five, up to {}/{}", option,
                  text, kMaxNumParts, kMaxNumParts));
}

Option PartOption(std::optional<VideoPart>* part) {
  const auto set = [part](const std::string& text, const std::string& option) {
    *part = ParsePart(text, option);
  };
  return {"video_part", ParsedValue{part, "", set}, "K/N",
          "import the K-th of N parts of a video, for database_merger; left out: all frames"};
}

CommandSyntax Declare(MarkerImporterCommandOptions* options) {
  PathOptions* paths = &options->paths;
  return {"marker_importer",
          "finds the markers in images or a video and writes them into a COLMAP database",
          "--image_path photos --camera_path camera.yml --layout_path layout.yml \\\n"
          "    --database_path database.db",
          {{"Input and output",
            {ImagePathOption(paths), CameraPathOption(paths), PriorShapePathOption(paths),
             Required(PathOption(
                 "database_path", PathUse::kWritesFile, &paths->database_path,
                 "COLMAP database, new or to be added to; images that it holds are skipped")),
             PathOption("frame_output_path", PathUse::kAddsToFolder,
                        &options->importer.frame_output_path,
                        "folder for the frames of a video that hold markers, as JPEG; left out: "
                        "none are written"),
             PartOption(&options->importer.part), ImportAnewOption(&options->importer),
             PresetOption(&options->preset)}},
           DescribeOptions(&options->markers, true),
           DescribeOptions(&options->importer.detection),
           DescribeOptions(&options->importer.video),
           DescribeOptions(&options->general)},
          &options->preset};
}

void Validate(MarkerImporterCommandOptions* options) {
  LogPreset(options->preset);
  RefuseVideoOptions(*options);
  MarkerImporterOptions& importer = options->importer;
  CompleteImporter(*options, &importer);
  importer.database_path = options->paths.database_path;
}

void Print(const ImportReport& report, const PathOptions& paths, std::ostream& out) {
  out << fmt::format("images_added: {}\n", report.num_images_added);
  out << fmt::format("images_present: {}\n", report.num_images_present);
  out << fmt::format("images_without_markers: {}\n", report.num_images_without_markers);
  out << fmt::format("images_skipped: {}\n", report.skipped.size());
  out << fmt::format("frames_damaged: {}\n", report.num_frames_damaged);
  out << fmt::format("markers: {}\n", report.num_markers);
  out << fmt::format("markers_rejected: {}\n", report.num_rejected);
  out << fmt::format("markers_without_corner_fit: {}\n", report.num_fallbacks);
  out << fmt::format("ids_not_in_layout: {}\n",
                     report.ids_not_in_layout.empty()
                         ? "none"
                         : fmt::format("{}", fmt::join(report.ids_not_in_layout, " ")));
  if (!paths.prior_shape_path.empty()) {
    out << fmt::format("markers_of_prior_shape: {}\n", report.prior_shape_agreement.num_known);
    out << fmt::format("markers_agreeing_with_prior_shape: {}\n",
                       report.prior_shape_agreement.num_agreeing);
  }
  out << fmt::format("pairs_with_matches: {}\n", report.num_pairs);
  out << fmt::format("database_path: {}\n", paths.database_path);
}

void Run(const MarkerImporterCommandOptions& options) {
  StageClock clock;
  const ImportReport report = ImportImages(options.importer);
  clock.EndImport(report.times, report.num_frames_read);
  LogStageTimes(clock);
  Print(report, options.paths, std::cout);
}

}  // namespace

Command MarkerImporter() {
  return MakeCommand<MarkerImporterCommandOptions>(Declare, Validate, Run);
}

}  // namespace velamap
