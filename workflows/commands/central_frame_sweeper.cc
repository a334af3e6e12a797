#include <algorithm>
#include <iostream>
#include <vector>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "workflows/commands/commands.h"
#include "workflows/options/option_effects.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/central_frame_sweep.h"
#include "workflows/run/progress.h"

namespace velamap {
namespace {

struct CentralFrameSweeperCommandOptions : CommandOptions {
  CentralFrameSweepOptions sweep;
};

// The options of the registration except the central frame, because the sweep tries many.
OptionGroup RegistrationGroup(RegistrationOptions* options) {
  OptionGroup group = DescribeOptions(options);
  const std::string central_frame = OptionName(group, &options->central_frame);
  const auto is_central_frame = [&](const Option& option) {
    return "--" + option.name == central_frame;
  };
  group.options.erase(std::remove_if(group.options.begin(), group.options.end(), is_central_frame),
                      group.options.end());
  return group;
}

CommandSyntax Declare(CentralFrameSweeperCommandOptions* options) {
  PathOptions* paths = &options->paths;
  CentralFrameSweepOptions* sweep = &options->sweep;
  sweep->registration.method = RegistrationMethod::kThesis;
  sweep->adjustment.backend = AdjustmentBackend::kMarkers;  // profits from a warm start
  return {"central_frame_sweeper",
          "repeats the thesis's method around many central frames, one row each",
          "--database_path database.db --layout_path layout.yml \\\n"
          "    --central_frames every:10 --output_path sweep.csv",
          {{"Input and output",
            {DatabaseInputOption(paths),
             Required(PathOption("output_path", PathUse::kWritesFile, &paths->output_path,
                                 "table of all central frames, CSV")),
             Common({"central_frames", &sweep->central_frames, "all|every:N|LIST",
                     "central frames: all images with markers, every N-th of them, or names or "
                     "frame numbers separated by commas"}),
             Common(PathOption(
                 "models_path", PathUse::kAddsToFolder, &sweep->models_path,
                 "folder for the metric model, shape.csv and shape.json of each central frame, in "
                 "a folder named after its image; left out: none are written")),
             {"warm_start", &sweep->warm_start, "0|1",
              "start each adjustment from the result around the previous central frame"},
             BackendOption(&sweep->adjustment.backend),
             ScaleOption(&sweep->scale_by),
             PresetOption(&options->preset),
             ColmapLogOption(paths)}},
           DescribeOptions(&options->markers, false),
           RegistrationGroup(&sweep->registration),
           DescribeOptions(&sweep->adjustment.colmap),
           DescribeOptions(&sweep->adjustment.markers),
           DescribeOptions(&options->general)},
          &options->preset};
}

void Validate(CentralFrameSweeperCommandOptions* options) {
  LogPreset(options->preset);
  CentralFrameSweepOptions& sweep = options->sweep;
  RefuseOptionsOfOtherMethod(options->typed, sweep.registration.method);
  RefuseOptionsOfOtherBackend(options->typed, sweep.adjustment.backend);
  sweep.database_path = options->paths.database_path;
  CompleteRegistration(options->general, &sweep.registration);
  sweep.adjustment.Complete(options->general.num_threads);
  sweep.log_path = options->paths.log_path;
  if (sweep.adjustment.UsesColmap()) CheckColmap(sweep.adjustment.colmap.colmap_path);
}

void Print(const std::vector<SweepRow>& rows, const std::string& output_path, std::ostream& out) {
  int num_results = 0;
  for (const SweepRow& row : rows) num_results += row.reason.empty();
  const SweepRow& best = rows[static_cast<std::size_t>(BestRow(rows))];
  out << fmt::format("central_frames: {} of {} with a result\n", num_results, rows.size());
  out << fmt::format("best_central_frame: {}\n", best.central_frame);
  out << fmt::format("best_num_markers: {}\n", best.shape.num_markers);
  out << fmt::format("best_area_error_mm2: {:.3f}\n", best.shape.area_error_mm2.mean);
  out << fmt::format("best_reprojection_error_px: {:.3f}\n", best.model.error_px.mean);
  out << fmt::format("table_path: {}\n", output_path);
}

void Run(const CentralFrameSweeperCommandOptions& options) {
  const Layout layout = LoadLayout(options.markers, false);
  StageClock clock;
  Progress progress("central frames");
  const std::vector<SweepRow> rows =
      SweepCentralFrames(options.sweep, layout, &clock,
                         [&progress](int done, int total) { progress.Update(done, total, ""); });
  ClearProgressLine();
  if (BestRow(rows) < 0) {
    throw DataError(fmt::format("{}: none of {} central frames gives a result; the first: {}",
                                options.paths.database_path, rows.size(), rows.front().reason));
  }
  WriteFileAtomically(options.paths.output_path,
                      [&rows](std::ostream& out) { WriteSweepCsv(rows, out); });
  LogStageTimes(clock);
  Print(rows, options.paths.output_path, std::cout);
}

}  // namespace

Command CentralFrameSweeper() {
  return MakeCommand<CentralFrameSweeperCommandOptions>(Declare, Validate, Run);
}

}  // namespace velamap
