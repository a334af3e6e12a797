#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "importer/base/atomic_output.h"
#include "importer/database/colmap_database.h"
#include "reconstruct/model/model_io.h"
#include "workflows/commands/commands.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/pipeline.h"
#include "workflows/run/stage_times.h"
#include "workflows/run/summary.h"

namespace velamap {
namespace {

struct Options {
  PathOptions paths;
  GeneralOptions general;
  MarkerOptions markers;
  AdjustmentOptions adjustment;
};

CommandSyntax Declare(Options* options) {
  PathOptions* paths = &options->paths;
  return {"bundle_adjuster",
          "refines cameras and points of a model",
          "--input_path sparse/seed --output_path sparse/0",
          {{"Input and output",
            {ModelInputOption(paths),
             Required({"output_path", &paths->output_path, "path", "folder of the adjusted model"}),
             {"log_path", &paths->log_path, "path",
              "COLMAP's output; left out: colmap.log beside output_path"},
             BackendOption(&options->adjustment.backend),
             {"database_path", &paths->database_path, "path",
              "database of the model's images, which holds the sigma of each corner (markers, "
              "optional)"}}},
           DescribeOptions(&options->markers, false),
           DescribeOptions(&options->adjustment.colmap),
           DescribeOptions(&options->adjustment.markers),
           DescribeOptions(&options->general)}};
}

void Validate(Options* options) {
  SetLogLevel(options->general.log_level);
  options->adjustment.Complete(options->general.num_threads);
  CheckReplaceableFolder(options->paths.output_path, ModelFileNames());
  if (options->paths.log_path.empty()) {
    options->paths.log_path = BesideFolder(options->paths.output_path, "colmap.log");
  }
}

// COLMAP's adjustment needs no layout.
Layout LoadAdjustmentLayout(const Options& options) {
  return options.adjustment.UsesMarkers() ? LoadLayout(options.markers, false) : Layout{};
}

CornerSigmas LoadCornerSigmas(const Options& options) {
  if (options.paths.database_path.empty() || !options.adjustment.UsesMarkers()) return {};
  const ColmapDatabase database(options.paths.database_path, ColmapDatabase::Mode::kReadOnly);
  return CornerSigmasOf(database.ReadImages(), database.ReadFormation());
}

void Print(const AdjustmentResult& result, const std::string& model_path, std::ostream& out) {
  fmt::print(out, "reprojection_error_before_px: {}\n", ErrorText(result.error_before_px));
  fmt::print(out, "reprojection_error_px: {}\n", ErrorText(result.error_after_px));
  fmt::print(out, "outliers_removed: {} of {} observations\n", result.num_removed,
             result.error_before_px.count);
  if (result.uncertainty) {
    fmt::print(out, "scale_sigma: {:.4f} %\n", 100.0 * result.uncertainty->relative_scale_sigma);
    fmt::print(out, "corners_above_4_sigma: {:.3f} %\n",
               100.0 * result.uncertainty->share_above_4_sigma);
  }
  fmt::print(out, "model_path: {}\n", model_path);
}

void Run(const Options& options) {
  StageClock clock;
  const Layout layout = LoadAdjustmentLayout(options);
  Model model = ReadModel(options.paths.input_path);
  const AdjustmentResult result = AdjustModel(options.adjustment, layout, LoadCornerSigmas(options),
                                              options.paths.log_path, &model);
  clock.End("adjust", static_cast<int>(model.images.size()));
  WriteAdjustedModel(model, result, options.paths.output_path);
  clock.End("export");
  LogStageTimes(clock);
  Print(result, options.paths.output_path, std::cout);
}

}  // namespace

Command BundleAdjuster() {
  const auto options = std::make_shared<Options>();
  options->adjustment.backend = AdjustmentBackend::kColmap;  // needs no more than a model
  return {Declare(options.get()), [options](const Arguments&) {
            Validate(options.get());
            Run(*options);
          }};
}

}  // namespace velamap
