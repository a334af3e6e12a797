#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "exporters/compare/comparison_ply.h"
#include "exporters/compare/comparison_report.h"
#include "exporters/compare/comparison_sigma.h"
#include "exporters/compare/shape_comparison.h"
#include "exporters/compare/surface_comparison.h"
#include "exporters/design/mesh_reader.h"
#include "exporters/formats/shape_csv.h"
#include "exporters/shape/shape_sigma.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "workflows/commands/commands.h"
#include "workflows/options/shared_options.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

struct Options : CommandOptions {
  AlignmentOptions alignment;
  MeshReadOptions mesh;
  std::string layout_path;
  std::string part;
  std::string uncertainty_path;
  std::string reference_uncertainty_path;
  std::string csv_path;
  std::string json_path;
  std::string surface_path;
  std::optional<double> color_limit_mm;
};

OptionGroup InputGroup(Options* options) {
  MeshReadOptions* mesh = &options->mesh;
  const auto set_unit = [mesh](const std::string& text, const std::string& option) {
    mesh->m_per_unit = MPerUnitFromName(text, option);
  };
  PathOptions* paths = &options->paths;
  return {
      "Input",
      {ShapeInputOption(paths),
       Required(PathOption("reference_path", PathUse::kReadsShape, &paths->reference_path,
                           "what the shape is compared with: shape.csv or its folder, or a surface "
                           "as .ply, .stl, .obj, .step or .iges")),
       Common({"reference_unit", ParsedValue{&mesh->m_per_unit, "", set_unit}, "m|mm",
               "unit of a .ply, .stl or .obj; left out: as velamap wrote it, else m for .ply, mm "
               "for .stl and .obj"}),
       {"chord_deviation", &mesh->chord_deviation_mm, "mm",
        "how far triangles may be from the faces of a .step or .iges", MoreThan(0)},
       Common(PathOption("layout_path", PathUse::kReadsLayout, &options->layout_path,
                         "layout file: names the reference part and the lines")),
       {"part", &options->part, "name", "compare the markers of this part only"},
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
        "for --align markers, such as 120,121,122"},
       ChoiceOption("align_start", &alignment->starts_as_is, {{false, "auto"}, {true, "as_is"}},
                    "best fit onto a surface: from several starts, or from where the shape is")}};
}

CommandSyntax Declare(Options* options) {
  return {
      "shape_comparer",
      "compares a shape with another one or with the surface of a design",
      "--shape_path shape --reference_path design.step --layout_path layout.yml",
      {InputGroup(options),
       AlignmentGroup(&options->alignment),
       {"Output",
        {Common(PathOption("output_path", PathUse::kWritesFile, &options->paths.output_path,
                           "PLY of the markers, coloured by their signed distance")),
         Common(
             PathOption("surface_path", PathUse::kWritesFile, &options->surface_path,
                        "PLY of the surface through the lines, coloured in the same way; needs a "
                        "layout")),
         {"color_limit", &options->color_limit_mm, "mm",
          "distance that gets the full colour; left out: the largest", MoreThan(0)},
         Common(PathOption("csv_path", PathUse::kWritesFile, &options->csv_path,
                           "file for all figures and tables")),
         PathOption("json_path", PathUse::kWritesFile, &options->json_path, "the same as JSON")}},
       DescribeOptions(&options->general)}};
}

void Validate(Options* options) {
  if (!options->surface_path.empty() && options->layout_path.empty()) {
    throw InputError("--surface_path: needs --layout_path, whose lines the surface goes through");
  }
  if (!options->alignment.marker_ids.empty() &&
      options->alignment.method != AlignmentMethod::kMarkers) {
    throw InputError("--align_markers: goes with --align markers only");
  }
}

// Whether the covariance belongs to the shape, by the sigmas of both.
bool BelongsTo(const PointCovariance& covariance, const MarkerShape& shape) {
  constexpr double kTolerance = 1e-3;
  for (const ShapeMarker& marker : shape.markers) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const auto idx = static_cast<std::size_t>(corner);
      if (!marker.x_in_shape_m[idx]) continue;
      const auto sigma_m = PointSigma(&covariance, marker.marker_id, corner);
      if (!sigma_m || !marker.sigma_m[idx] ||
          (*sigma_m - *marker.sigma_m[idx]).norm() > kTolerance * sigma_m->norm()) {
        return false;
      }
    }
  }
  return true;
}

// `option` gives `uncertainty_path` and stands in messages.
UncertainShape ReadUncertainShape(const std::string& path, const std::string& uncertainty_path,
                                  const std::string& option) {
  const bool is_folder = IsFolder(path);
  UncertainShape result;
  result.shape = ReadShapeCsv(is_folder ? (fs::path(path) / "shape.csv").string() : path);
  fs::path folder = uncertainty_path;
  if (folder.empty() && is_folder) {
    folder = AbsoluteFolder(path).parent_path() / "sparse" / "0";
  }
  if (!uncertainty_path.empty() && !HasUncertainty(folder.string())) {
    throw InputError(
        fmt::format("{}: {} holds no {}; give the folder of a model that velamap bundle_adjuster "
                    "--backend markers has adjusted",
                    option, uncertainty_path, kUncertaintyFileName));
  }
  if (!folder.empty() && HasUncertainty(folder.string())) {
    const PointCovariance covariance = ReadUncertainty(folder.string()).points;
    if (BelongsTo(covariance, result.shape)) {
      spdlog::info("{}: joint uncertainty from {}", path, folder.string());
      result.covariance = covariance;
      return result;
    }
    if (!uncertainty_path.empty()) {
      throw InputError(
          fmt::format("{}: the uncertainty in {} does not belong to {}: the sigmas differ", option,
                      uncertainty_path, path));
    }
  }
  result.covariance = CovarianceFromSigmas(result.shape);
  return result;
}

void CheckUnit(const Options& options, const MarkerShape& shape, const MeshDistance& mesh) {
  const std::optional<double> factor = UnitHint(shape, mesh);
  if (!factor) return;
  const std::string& path = options.paths.reference_path;
  const std::string what = fmt::format("{}: is {:.3g} m across, which does not match the shape",
                                       path, mesh.Diagonal_m());
  if (HasOwnUnit(path) || options.mesh.m_per_unit) {
    spdlog::warn("{}; is its unit right?", what);
    return;
  }
  throw InputError(
      fmt::format("{}; if its unit is {}, give --reference_unit {}; if it is right as "
                  "it is, --reference_unit {}",
                  what, *factor > 1 ? "m" : "mm", *factor > 1 ? "m" : "mm",
                  DefaultMPerUnit(path) == 1.0 ? "m" : "mm"));
}

struct Result {
  ShapeDeviation deviation;
  SurfaceComparison surfaces;  // empty without a layout
};

Result CompareWithSurface(const Options& options, const UncertainShape& shape,
                          const Layout& layout) {
  const std::string& path = options.paths.reference_path;
  const MeshDistance mesh(ReadMesh(path, options.mesh));
  CheckUnit(options, shape.shape, mesh);
  if (mesh.NumFlippedEdges() > 0) {
    spdlog::warn(
        "{}: the triangles at {} edges face opposite sides, where the signs of distances are "
        "arbitrary",
        path, mesh.NumFlippedEdges());
  }
  Result result;
  result.deviation = CompareWithMesh(shape, mesh, layout, options.alignment, options.part);
  result.surfaces = CompareSurfaces(result.deviation.aligned_shape, mesh, layout, options.part);
  return result;
}

Result CompareWithOther(const Options& options, const UncertainShape& shape, const Layout& layout,
                        MetricsReport* report) {
  const UncertainShape reference =
      ReadUncertainShape(options.paths.reference_path, options.reference_uncertainty_path,
                         "--reference_uncertainty_path");
  Result result;
  result.deviation = CompareWithShape(shape, reference, layout, options.alignment, options.part);
  AddMetrics(result.deviation, report);
  if (options.layout_path.empty()) return result;
  AddMetrics(CompareSections(shape, reference, result.deviation.alignment, layout), report);
  result.surfaces =
      CompareSurfaces(result.deviation.aligned_shape, reference.shape, layout, options.part);
  AddMetrics(result.surfaces, report);
  return result;
}

Result Compare(const Options& options, MetricsReport* report) {
  Layout layout;
  if (!options.layout_path.empty()) layout = ReadLayout(options.layout_path);
  const UncertainShape shape =
      ReadUncertainShape(options.paths.shape_path, options.uncertainty_path, "--uncertainty_path");
  if (!IsMeshPath(options.paths.reference_path)) {
    return CompareWithOther(options, shape, layout, report);
  }
  Result result = CompareWithSurface(options, shape, layout);
  AddMetrics(result.deviation, report);
  if (!options.layout_path.empty()) AddMetrics(result.surfaces, report);
  return result;
}

void Write(const Options& options, const Result& result, const MetricsReport& report) {
  const auto write = [](const std::string& path, const auto& writer) {
    if (!path.empty()) WriteFileAtomically(path, writer);
  };
  std::optional<double> limit_m;
  if (options.color_limit_mm) limit_m = *options.color_limit_mm / 1e3;
  write(options.csv_path, [&](std::ostream& out) { WriteMetricsCsv(report, out); });
  write(options.json_path, [&](std::ostream& out) { WriteMetricsJson(report, out); });
  write(options.paths.output_path,
        [&](std::ostream& out) { WriteComparisonPly(result.deviation, limit_m, out); });
  write(options.surface_path,
        [&](std::ostream& out) { WriteComparisonSurfacePly(result.surfaces, limit_m, out); });
}

void Run(const Options& options) {
  MetricsReport report;
  const Result result = Compare(options, &report);
  DropRoundingErrors(&report);
  Write(options, result, report);
  PrintMetrics(report, std::cout);
}

}  // namespace

Command ShapeComparer() { return MakeCommand(std::make_shared<Options>(), Declare, Validate, Run); }

}  // namespace velamap
