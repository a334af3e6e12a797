#include <iostream>

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "importer/atomic_output.h"
#include "reconstruct/model_io.h"
#include "workflows/commands.h"
#include "workflows/pipeline.h"
#include "workflows/shared_options.h"
#include "workflows/summary.h"

namespace velamap {
namespace {

struct Options {
  PathOptions paths;
  GeneralOptions general;
  std::string backend = "colmap";
  BundleAdjustmentOptions adjustment;
};

CommandSyntax Declare(Options* options) {
  PathOptions* paths = &options->paths;
  return {"bundle_adjuster",
          "refines cameras and points of a model",
          "--input_path sparse/seed --output_path sparse/0",
          {{"Input and output",
            {ModelInputOption(paths),
             {"output_path", &paths->output_path, "path", "folder of the adjusted model", true},
             {"log_path", &paths->log_path, "path",
              "COLMAP's output; left out: colmap.log beside output_path"},
             {"backend", &options->backend, "name", "colmap: COLMAP's own program"}}},
           BundleAdjustmentGroup(&options->adjustment),
           GeneralGroup(&options->general)}};
}

void Validate(Options* options) {
  ApplyGeneralOptions(options->general);
  CheckBackend(options->backend);
  options->adjustment.Check();
  CheckReplaceableFolder(options->paths.output_path, ModelFileNames());
  if (options->paths.log_path.empty()) {
    options->paths.log_path = BesideFolder(options->paths.output_path, "colmap.log");
  }
}

void Print(const BundleAdjustmentSummary& summary, const std::string& model_path,
           std::ostream& out) {
  fmt::print(out, "rounds: {}\n", summary.num_rounds);
  fmt::print(out, "reprojection_error_before_px: {}\n", ErrorText(summary.error_before_px));
  fmt::print(out, "reprojection_error_px: {}\n", ErrorText(summary.error_after_px));
  fmt::print(out, "outliers_removed: {} of {} observations\n", summary.removed.size(),
             summary.error_before_px.count);
  fmt::print(out, "model_path: {}\n", model_path);
}

}  // namespace

void RunBundleAdjuster(const Arguments& arguments) {
  Options options;
  if (!ParseOrPrintHelp(Declare(&options), arguments)) return;
  Validate(&options);
  Model model = ReadModel(options.paths.input_path);
  const BundleAdjustmentSummary summary =
      AdjustModel(options.adjustment, options.paths.log_path, &model);
  WriteModel(model, options.paths.output_path, ModelFormat::kBinaryAndText);
  Print(summary, options.paths.output_path, std::cout);
}

}  // namespace velamap
