#include <iostream>
#include <optional>

#include "exporters/report/verdict.h"
#include "importer/base/error.h"
#include "reconstruct/camera/camera_steadiness.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model_io.h"
#include "workflows/commands/commands.h"
#include "workflows/options/option_effects.h"
#include "workflows/options/sail_options.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/report_input.h"
#include "workflows/run/stage_times.h"
#include "workflows/run/summary.h"
#include "workflows/run/version.h"

namespace velamap {
namespace {

struct ShapeExporterCommandOptions : CommandOptions {
  ShapeExporterOptions exporter;
  SurfaceFileOptions surface;
};

CommandSyntax Declare(ShapeExporterCommandOptions* options) {
  PathOptions* paths = &options->paths;
  CommandSyntax syntax = {
      "shape_exporter",
      "scales a model to metres by the markers' sides and writes the shape",
      "--input_path sparse/0 --layout_path layout.yml --output_path metric --shape_path shape",
      {{"Input and output",
        {ModelInputOption(paths),
         Common(PathOption("output_path", PathUse::kWritesFolder, &paths->output_path,
                           "folder of the metric model; left out: it is not written")),
         Common(PathOption(
             "shape_path", PathUse::kWritesFolder, &paths->shape_path,
             "folder of shape.csv, sections, surface, PLY and CAD files; left out: none is "
             "written")),
         {"ascii_ply", &options->exporter.files.ascii_ply, "0|1", "PLY as text instead of binary"},
         {"metashape", &options->exporter.metashape, "0|1",
          "also write the corners as markers and as reference coordinates for Agisoft Metashape"},
         {"alicevision", &options->exporter.alicevision, "0|1",
          "also write images, cameras, poses and corners for AliceVision and Meshroom"},
         PresetOption(&options->preset)}},
       DescribeOptions(&options->markers, false)}};
  for (const OptionGroup& group : SailGroups(&options->exporter, &options->surface)) {
    syntax.groups.push_back(group);
  }
  syntax.groups.push_back(DescribeOptions(&options->general));
  syntax.preset = &options->preset;
  return syntax;
}

void Validate(ShapeExporterCommandOptions* options) {
  LogPreset(options->preset);
  if (options->paths.output_path.empty() && options->paths.shape_path.empty()) {
    throw InputError(
        "--shape_path: missing; give --shape_path, --output_path or both to say what to write");
  }
  if (options->paths.shape_path.empty()) {
    RefuseOptionsWithoutEffect(options->typed,
                               {"ascii_ply", "metashape", "alicevision", "unit",
                                "Surface.grid_sections", "Surface.grid_points"},
                               "without --shape_path no files of the shape are written");
  }
  CompleteSailOptions(options->surface, &options->exporter);
  options->exporter.model_output_path = options->paths.output_path;
  options->exporter.shape_output_path = options->paths.shape_path;
  options->exporter.origin.version = kVersion;
  options->exporter.num_threads = options->general.num_threads;
}

Verdict Judge(const ShapeExportReport& report, const Layout& layout) {
  WarnOfOtherMarkers(report.metrics);
  WarnOfMissingSections(report.sail.sections);
  ReportInput input =
      MakeReportInput(report, layout, WithoutDoubtfulStep(JudgeSteadiness(report.metric_model)));
  input.warnings = WarningsBeforeContradictions(report);
  return MakeVerdict(input);
}

void Print(const ShapeExportReport& report, const Verdict& verdict, const PathOptions& paths,
           std::ostream& out) {
  PrintVerdict(verdict, out);
  PrintShapeSummary(report, out);
  if (!paths.shape_path.empty()) out << "shape_path: " << paths.shape_path << '\n';
  if (!paths.output_path.empty()) out << "model_path: " << paths.output_path << '\n';
}

void Run(const ShapeExporterCommandOptions& options) {
  StageClock clock;
  const Layout layout = LoadLayout(options.markers, false);
  RefuseSailOptions(options.typed, layout);
  const Model model = ReadModel(options.paths.input_path);
  const std::optional<AdjustmentUncertainty> uncertainty =
      ReadUncertaintyOf(model, options.paths.input_path);
  if (uncertainty) {
    RefuseOptionsWithoutEffect(options.typed, {"scale_by"},
                               "the model in --input_path " + options.paths.input_path +
                                   " is metric already, from an adjustment with markers");
  }
  const ShapeExportReport report =
      ComputeShape(model, layout, options.exporter, uncertainty ? &*uncertainty : nullptr);
  report.ThrowSurfaceErrorBeforeReplacing({options.paths.output_path, options.paths.shape_path});
  const Verdict verdict = Judge(report, layout);
  WriteShape(report, options.exporter, &verdict);
  clock.End("export");
  LogStageTimes(clock);
  report.ThrowSurfaceError();
  Print(report, verdict, options.paths, std::cout);
}

}  // namespace

Command ShapeExporter() { return MakeCommand<ShapeExporterCommandOptions>(Declare, Validate, Run); }

}  // namespace velamap
