#include <iostream>
#include <optional>

#include "importer/error.h"
#include "reconstruct/adjustment_uncertainty.h"
#include "reconstruct/model_io.h"
#include "workflows/commands.h"
#include "workflows/shared_options.h"
#include "workflows/summary.h"

namespace velamap {
namespace {

struct Options {
  PathOptions paths;
  MarkerOptions markers;
  GeneralOptions general;
  bool ascii_ply = false;
};

CommandSyntax Declare(Options* options) {
  PathOptions* paths = &options->paths;
  return {"shape_exporter",
          "scales a model to metres by the markers' sides and writes the shape",
          "--input_path sparse/0 --layout_path layout.yml --output_path metric --shape_path shape",
          {{"Input and output",
            {ModelInputOption(paths),
             {"output_path", &paths->output_path, "path",
              "folder of the metric model; left out: it is not written"},
             {"shape_path", &paths->shape_path, "path",
              "folder of shape.csv, PLY files, scale.csv and metrics; left out: none is written"},
             {"ascii_ply", &options->ascii_ply, "0|1", "PLY as text instead of binary"}}},
           MarkerGroup(&options->markers, false),
           GeneralGroup(&options->general)}};
}

void Validate(const Options& options) {
  ApplyGeneralOptions(options.general);
  if (options.paths.output_path.empty() && options.paths.shape_path.empty()) {
    throw InputError(
        "--shape_path: missing; give --shape_path, --output_path or both to say what to write");
  }
}

void Print(const ShapeExportReport& report, const PathOptions& paths, std::ostream& out) {
  PrintShapeSummary(report, out);
  if (!paths.shape_path.empty()) out << "shape_path: " << paths.shape_path << '\n';
  if (!paths.output_path.empty()) out << "model_path: " << paths.output_path << '\n';
}

}  // namespace

void RunShapeExporter(const Arguments& arguments) {
  Options options;
  if (!ParseOrPrintHelp(Declare(&options), arguments)) return;
  Validate(options);
  const Layout layout = LoadLayout(options.markers, false);
  const Model model = ReadModel(options.paths.input_path);
  std::optional<AdjustmentUncertainty> uncertainty;
  if (HasUncertainty(options.paths.input_path)) {
    uncertainty = ReadUncertainty(options.paths.input_path);
  }
  const ShapeExportReport report =
      ExportShape(model, layout,
                  {options.paths.output_path, options.paths.shape_path, options.ascii_ply},
                  uncertainty ? &*uncertainty : nullptr);
  Print(report, options.paths, std::cout);
}

}  // namespace velamap
