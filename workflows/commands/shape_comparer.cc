#include <functional>
#include <iostream>
#include <optional>

#include <fmt/format.h>

#include "exporters/compare/comparison.h"
#include "exporters/comparison_page/comparison_page.h"
#include "exporters/comparison_page/comparison_ply.h"
#include "exporters/design/mesh_reader.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/replacement.h"
#include "importer/geometry/units.h"
#include "importer/text/output_date.h"
#include "workflows/commands/commands.h"
#include "workflows/commands/compared_shapes.h"
#include "workflows/options/option_effects.h"
#include "workflows/options/path_check.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/progress.h"
#include "workflows/run/version.h"

namespace velamap {
namespace {

struct ShapeComparerCommandOptions : CommandOptions {
  ComparisonOptions comparison;
  MeshReadOptions mesh;
  std::vector<std::string> series_paths;
  std::string layout_path;
  std::string uncertainty_path;
  std::string reference_uncertainty_path;
  std::string csv_path;
  std::string json_path;
  std::string surface_path;
  std::string comparison_path;
  std::optional<double> color_limit_mm;
};

OptionGroup InputGroup(ShapeComparerCommandOptions* options) {
  MeshReadOptions* mesh = &options->mesh;
  PathOptions* paths = &options->paths;
  std::vector<std::string>* series_paths = &options->series_paths;
  const auto set_series = [series_paths](const std::string& text, const std::string& option) {
    *series_paths = PathsFromText(text, option, "trim2/shape,trim3/shape");
  };
  return {
      "Input",
      {ShapeInputOption(paths),
       Required(PathOption("reference_path", PathUse::kReadsShape, &paths->reference_path,
                           "what the shape is compared with: shape.csv or its folder, or a surface "
                           "as .ply, .stl, .obj, .step or .iges")),
       Common({"series_paths", ParsedValue{series_paths, "", set_series}, "shapes",
               "more shapes for the same comparison, such as the other trims of a series: "
               "trim2/shape,trim3/shape"}),
       Common(MeshUnitOption("reference_unit", mesh)),
       {"chord_deviation", &mesh->chord_deviation_mm, "mm",
        "how far triangles may be from the faces of a .step or .iges", FromTo(0.001, 1000)},
       Common(PathOption("layout_path", PathUse::kReadsLayout, &options->layout_path,
                         "layout file: names the reference part and the lines")),
       {"part", &options->comparison.part, "name", "compare the markers of this part only"},
       PathOption("uncertainty_path", PathUse::kReadsModel, &options->uncertainty_path,
                  "folder of the shape's model with its uncertainty.bin, for sigmas with "
                  "correlations between the markers; left out: ../sparse/0 of a shape folder, else "
                  "the sigmas of shape.csv"),
       PathOption("reference_uncertainty_path", PathUse::kReadsModel,
                  &options->reference_uncertainty_path, "the same for the reference")}};
}

OptionGroup AlignmentGroup(AlignmentOptions* alignment) {
  const auto set_method = [alignment](const std::string& text, const std::string& option) {
    alignment->method = AlignmentMethodFromName(text, option);
  };
  const auto set_ids = [alignment](const std::string& text, const std::string& option) {
    alignment->marker_ids = MarkerIdsFromText(text, option);
  };
  return {
      "Alignment (rigid, scale is never fitted)",
      {Common(
           {"align",
            ParsedValue{&alignment->method, AlignmentMethodName(alignment->method), set_method},
            "method",
            "auto, reference_part, markers, best_fit or none; auto: the reference part where three "
            "of its markers are in both, else best fit"}),
       {"align_markers", ParsedValue{&alignment->marker_ids, "", set_ids}, "ids",
        "for --align markers, such as 120,125-130"},
       ChoiceOption("align_start", &alignment->starts_as_is, {{false, "auto"}, {true, "as_is"}},
                    "best fit onto a surface: from several starts, or from where the shape is")}};
}

OptionGroup OutputGroup(ShapeComparerCommandOptions* options) {
  return {
      "Output",
      {Common(PathOption("comparison_path", PathUse::kWritesFolder, &options->comparison_path,
                         "folder for comparison.html, a page with profiles, sections, the coloured "
                         "surface and markers; with a layout also for deflection.csv and "
                         "deflection.vts, a vector for each point of a grid on the sail")),
       Common(PathOption("output_path", PathUse::kWritesFile, &options->paths.output_path,
                         "PLY of the markers, coloured by their signed distance")),
       Common(PathOption("surface_path", PathUse::kWritesFile, &options->surface_path,
                         "PLY of the surface through the lines, coloured in the same way; needs a "
                         "layout")),
       {"color_limit", &options->color_limit_mm, "mm",
        "distance that gets the full colour; left out: the largest", MoreThan(0)},
       Common(PathOption("csv_path", PathUse::kWritesFile, &options->csv_path,
                         "file for all figures and tables")),
       PathOption("json_path", PathUse::kWritesFile, &options->json_path, "the same as JSON")}};
}

CommandSyntax Declare(ShapeComparerCommandOptions* options) {
  return {"shape_comparer",
          "compares shapes with another shape or with the surface of a design",
          "--shape_path trim2/shape --series_paths trim3/shape,trim4/shape --reference_path "
          "trim1/shape --layout_path layout.yml --comparison_path comparison",
          {InputGroup(options), AlignmentGroup(&options->comparison.alignment),
           DescribeOptions(&options->comparison.edge), OutputGroup(options),
           DescribeOptions(&options->comparison.grid), DescribeOptions(&options->general)}};
}

// ParseOptions() checks only options that hold a single path.
void CheckSeries(const ShapeComparerCommandOptions& options) {
  if (options.series_paths.empty()) return;
  for (const auto& [option, path] : {std::pair{"--output_path", options.paths.output_path},
                                     std::pair{"--surface_path", options.surface_path},
                                     std::pair{"--uncertainty_path", options.uncertainty_path}}) {
    if (path.empty()) continue;
    throw InputError(fmt::format(
        "{}: is for one shape; leave out --series_paths, or give --comparison_path for all of them",
        option));
  }
  std::vector<UsedPath> inputs, outputs;
  for (const std::string& path : options.series_paths) {
    inputs.push_back({"--series_paths", ShapeFile(path)});
    CheckInputKind("--series_paths", ShapeFile(path));
  }
  const auto add = [&](const char* option, const std::string& path, bool is_folder) {
    if (!path.empty()) outputs.push_back({option, path, is_folder});
  };
  add("--csv_path", options.csv_path, false);
  add("--json_path", options.json_path, false);
  add("--comparison_path", options.comparison_path, true);
  CheckOutputs(inputs, outputs);
}

void RefuseUnusedOptions(const ShapeComparerCommandOptions& options) {
  const std::string& reference = options.paths.reference_path;
  const AlignmentMethod align = options.comparison.alignment.method;
  const std::string what = "the --reference_path " + reference;
  if (!IsMeshPath(reference)) {
    RefuseOptionsWithoutEffect(options.typed, {"reference_unit", "chord_deviation", "align_start"},
                               what + " is a shape in m, not a surface");
    if (options.layout_path.empty()) {
      RefuseOptionsWithoutEffect(options.typed, {"edge_tolerance"},
                                 "without --layout_path, no surfaces of the shapes are compared");
    }
  } else {
    RefuseOptionsWithoutEffect(options.typed, {"reference_uncertainty_path"},
                               what + " is a surface, which has no uncertainty");
    if (HasOwnUnit(reference)) {
      RefuseOptionsWithoutEffect(options.typed, {"reference_unit"},
                                 what + " names its unit itself");
    } else {
      RefuseOptionsWithoutEffect(options.typed, {"chord_deviation"},
                                 what + " consists of triangles already");
    }
  }
  if (align != AlignmentMethod::kAuto && align != AlignmentMethod::kBestFit) {
    RefuseOptionsWithoutEffect(options.typed, {"align_start"}, "--align is not best_fit");
  }
  if (options.comparison_path.empty() || options.layout_path.empty()) {
    RefuseOptionsWithoutEffect(options.typed, {"Surface."},
                               "a grid is written with --comparison_path and --layout_path only");
  }
  if (options.comparison_path.empty() && options.paths.output_path.empty() &&
      options.surface_path.empty()) {
    RefuseOptionsWithoutEffect(options.typed, {"color_limit"},
                               "no picture is written (--comparison_path, --output_path or "
                               "--surface_path)");
  }
}

// A page or a table is another option's.
void CheckIsPly(const char* option, const std::string& path) {
  const std::string extension = LowerExtension(path);
  if (extension.empty() || extension == ".ply") return;
  throw InputError(fmt::format(
      "{}: '{}' would hold a PLY file; name it .ply, or give --comparison_path for a page "
      "(comparison.html), --csv_path or --json_path for the figures",
      option, path));
}

void Validate(ShapeComparerCommandOptions* options) {
  RefuseUnusedOptions(*options);
  if (!options->surface_path.empty() && options->layout_path.empty()) {
    throw InputError("--surface_path: needs --layout_path, whose lines the surface goes through");
  }
  CheckIsPly("--output_path", options->paths.output_path);
  CheckIsPly("--surface_path", options->surface_path);
  const AlignmentOptions& alignment = options->comparison.alignment;
  if (!alignment.marker_ids.empty() && alignment.method != AlignmentMethod::kMarkers) {
    throw InputError("--align_markers: needs --align markers");
  }
  options->comparison.with_deflections = !options->comparison_path.empty();
  CheckSeries(*options);
}

// Calls `progress` with the number of shapes that have been compared, from 0.
std::vector<Comparison> CompareAll(const ShapeComparerCommandOptions& options, const Layout& layout,
                                   const std::function<void(int)>& progress,
                                   std::optional<UncertainShape>* reference) {
  progress(0);
  std::vector<std::string> paths = {options.paths.shape_path};
  paths.insert(paths.end(), options.series_paths.begin(), options.series_paths.end());
  const std::vector<std::string> names = NamesOfShapes(paths);
  const std::string& reference_path = options.paths.reference_path;
  std::vector<UncertainShape> shapes;
  for (const std::string& path : paths) {
    shapes.push_back(ReadUncertainShape(path, options.uncertainty_path, "--uncertainty_path"));
  }
  ComparisonOptions comparison = options.comparison;
  std::optional<MeshDistance> mesh;
  std::optional<SeriesReference> shared;
  if (IsMeshPath(reference_path)) {
    mesh.emplace(ReadMesh(reference_path, options.mesh));
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      CheckMetres(paths[i], shapes[i].shape, layout);
      CheckUnit(reference_path, options.mesh, "reference_unit", shapes[i].shape, *mesh);
    }
    CheckFaces(reference_path, *mesh);
    comparison.surface_sigma_m = SurfaceSigma(reference_path);
  } else {
    *reference = ReadUncertainShape(reference_path, options.reference_uncertainty_path,
                                    "--reference_uncertainty_path");
    CountAsExact(reference_path, &**reference);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      CheckMetres(paths[i], shapes[i].shape, reference_path, (*reference)->shape, layout);
    }
    shared.emplace(**reference);
  }
  std::vector<Comparison> series;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    try {
      series.push_back(mesh ? Compare(names[i], shapes[i], *mesh, layout, comparison)
                            : Compare(names[i], shapes[i], *shared, layout, comparison));
      progress(static_cast<int>(i) + 1);
    } catch (const DataError& error) {
      if (shapes.size() == 1) throw;
      throw DataError(fmt::format("{}: {}", paths[i], error.what()));
    }
  }
  return series;
}

void WriteComparisonFolder(const ShapeComparerCommandOptions& options, const Layout& layout,
                           const std::optional<UncertainShape>& reference,
                           const std::vector<Comparison>& series) {
  ComparisonPageInput input{series, reference ? &reference->shape : nullptr, layout};
  input.reference_name = NamesOfShapes({options.paths.reference_path}).front();
  input.version = kVersion;
  input.created = DateText(OutputDate());
  input.color_limit_mm = options.color_limit_mm;
  AtomicFolder folder(options.comparison_path);
  WriteComparisonFiles(input, folder.TemporaryPath());
  folder.Commit();
}

void Write(const ShapeComparerCommandOptions& options, const Comparison& first,
           const MetricsReport& report) {
  const auto write = [](const std::string& path, const auto& writer) {
    if (!path.empty()) WriteFileAtomically(path, writer);
  };
  std::optional<double> limit_m;
  if (options.color_limit_mm) limit_m = *options.color_limit_mm / kMmPerM;
  write(options.csv_path, [&](std::ostream& out) { WriteMetricsCsv(report, out); });
  write(options.json_path, [&](std::ostream& out) { WriteMetricsJson(report, out); });
  write(options.paths.output_path,
        [&](std::ostream& out) { WriteComparisonPly(first.deviation, limit_m, out); });
  write(options.surface_path,
        [&](std::ostream& out) { WriteComparisonSurfacePly(first.surfaces, limit_m, out); });
}

void Run(const ShapeComparerCommandOptions& options) {
  Layout layout;
  if (!options.layout_path.empty()) layout = ReadLayout(options.layout_path);
  std::optional<UncertainShape> reference;
  const auto num_shapes = static_cast<int>(1 + options.series_paths.size());
  const int num_steps = num_shapes + 1;  // the last one writes
  Progress progress("comparing shapes");
  const std::vector<Comparison> series = CompareAll(
      options, layout, [&](int i) { progress.Update(i, num_steps, ""); }, &reference);
  const MetricsReport report = MakeComparisonReport(series);
  Write(options, series.front(), report);
  if (!options.comparison_path.empty()) {
    WriteComparisonFolder(options, layout, reference, series);
  }
  ClearProgressLine();
  PrintMetrics(report, std::cout);
}

}  // namespace

Command ShapeComparer() { return MakeCommand<ShapeComparerCommandOptions>(Declare, Validate, Run); }

}  // namespace velamap
