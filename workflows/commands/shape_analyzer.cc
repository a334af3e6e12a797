#include <iostream>
#include <optional>

#include "exporters/datum/known_points_report.h"
#include "exporters/formats/shape_csv.h"
#include "exporters/scale/metric_shape.h"
#include "exporters/scale/scale_audit_report.h"
#include "exporters/shape_report.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/log.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model_io.h"
#include "workflows/commands/commands.h"
#include "workflows/commands/compared_shapes.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/summary.h"

namespace velamap {
namespace {

struct ShapeAnalyzerCommandOptions : CommandOptions {
  bool part_planes = false;
  std::string csv_path;
  std::string json_path;
};

CommandSyntax Declare(ShapeAnalyzerCommandOptions* options) {
  PathOptions* paths = &options->paths;
  return {
      "shape_analyzer",
      "judges a shape by its markers, its images and a reference",
      "--shape_path shape --layout_path layout.yml --input_path sparse/0",
      {{"Input and output",
        {ShapeInputOption(paths),
         Common(PathOption("input_path", PathUse::kReadsModel, &paths->input_path,
                           "folder of the COLMAP model that the shape is from; for reprojection "
                           "errors")),
         Common(
             PathOption("reference_path", PathUse::kReadsShape, &paths->reference_path,
                        "shape.csv of the truth or the design; the shape is aligned with it, and "
                        "distances of adjacent markers are compared")),
         {"part_planes", &options->part_planes, "0|1",
          "fit a plane to every part and compare the planes"},
         Common(PathOption("csv_path", PathUse::kWritesFile, &options->csv_path,
                           "file for all metrics and the tables of markers and distances")),
         PathOption("json_path", PathUse::kWritesFile, &options->json_path, "the same as JSON")}},
       DescribeOptions(&options->markers, false),
       DescribeOptions(&options->general)}};
}

void Validate(ShapeAnalyzerCommandOptions* options) {
  const PathOptions& paths = options->paths;
  if (!HasMarkerOptions(options->markers) && paths.reference_path.empty() &&
      paths.input_path.empty() && !options->part_planes) {
    throw InputError(
        "--layout_path: missing; give it or --marker_length to judge the markers' size, "
        "--input_path for reprojection errors, --reference_path to compare, or --part_planes 1");
  }
}

// Warns unless the shape is similar to the corners of the model: otherwise they are from different
// runs.
void CheckModelOfShape(const Model& model, const MarkerShape& shape, const PathOptions& paths) {
  constexpr double kTolerance_m = 1e-6;
  const auto max_distance_m = [&] {
    try {
      return ComputeReferenceMetrics(ShapeFromModel(model, Layout()), shape)
          .distance_after_scaling_m.max;
    } catch (const DataError&) {
      throw InputError("--input_path " + paths.input_path +
                       ": shares fewer than three corners with " + paths.shape_path +
                       "; give the model that the shape is from");
    }
  }();
  if (max_distance_m <= kTolerance_m) return;
  LogWarning(
      "{} is not the shape of the model {}: corners differ by up to {:.6f} m, so the model's "
      "errors are not those of the shape",
      paths.shape_path, paths.input_path, max_distance_m);
}

// The model of the shape, and its uncertainty if both have the same points.
struct ModelOfShape {
  std::optional<Model> model;
  std::optional<AdjustmentUncertainty> uncertainty;
};

ModelOfShape LoadModel(const MarkerShape& shape, const PathOptions& paths) {
  ModelOfShape result;
  if (paths.input_path.empty()) return result;
  result.model = ReadModel(paths.input_path);
  CheckModelOfShape(*result.model, shape, paths);
  if (IsShapeOf(shape, *result.model)) {
    result.uncertainty = ReadUncertaintyOf(*result.model, paths.input_path);
  } else if (HasUncertainty(paths.input_path)) {
    LogWarning(
        "{}: its joint uncertainty is not used, because the shape is in another frame; export both "
        "with one command",
        paths.input_path);
  }
  return result;
}

MetricsReport Analyze(const ShapeAnalyzerCommandOptions& options) {
  const MarkerShape shape = ReadShapeCsv(ShapeFile(options.paths.shape_path));
  const std::optional<Layout> layout = LoadGivenLayout(options.markers, false);
  const ModelOfShape source = LoadModel(shape, options.paths);
  const PointCovariance* covariance = source.uncertainty ? &source.uncertainty->points : nullptr;
  MetricsReport report;
  if (layout) {
    const ShapeMetrics metrics = ComputeShapeMetrics(shape, *layout, covariance);
    WarnOfOtherMarkers(metrics);
    AddMetrics(metrics, &report);
  }
  if (source.model) {
    AddMetrics(ComputeModelMetrics(*source.model, MarkerIds(layout.value_or(Layout()))), &report);
  }
  if (layout) {
    AddMetrics(AuditScale(shape, *layout, source.model ? &*source.model : nullptr,
                          source.uncertainty ? &*source.uncertainty : nullptr),
               &report);
  }
  if (layout) AddMetrics(FitKnownPoints(shape, *layout, covariance), &report);
  if (source.uncertainty) AddMetrics(*source.uncertainty, &report);
  if (options.part_planes) AddMetrics(FitPartPlanes(shape, covariance), &report, covariance);
  if (!options.paths.reference_path.empty()) {
    const MarkerShape reference = ReadShapeCsv(ShapeFile(options.paths.reference_path));
    CheckMetres(options.paths.shape_path, shape, options.paths.reference_path, reference,
                layout.value_or(Layout()));
    AddMetrics(ComputeReferenceMetrics(shape, reference, covariance), &report);
    if (layout) {
      AddMetrics(CompareAdjacentDistances(shape, reference, *layout, covariance), &report);
    }
  }
  return report;
}

void Run(const ShapeAnalyzerCommandOptions& options) {
  const MetricsReport report = Analyze(options);
  if (!options.csv_path.empty()) {
    WriteFileAtomically(options.csv_path,
                        [&report](std::ostream& out) { WriteMetricsCsv(report, out); });
  }
  if (!options.json_path.empty()) {
    WriteFileAtomically(options.json_path,
                        [&report](std::ostream& out) { WriteMetricsJson(report, out); });
  }
  PrintMetrics(report, std::cout);
}

}  // namespace

Command ShapeAnalyzer() { return MakeCommand<ShapeAnalyzerCommandOptions>(Declare, Validate, Run); }

}  // namespace velamap
