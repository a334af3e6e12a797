#include "exporters/compare/comparison.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "exporters/compare/comparison_report.h"
#include "importer/base/files.h"

namespace velamap {
namespace {

MetricsReport ReportOf(const Comparison& comparison) {
  MetricsReport report;
  AddMetrics(comparison.deviation, &report);
  if (comparison.has_layout) {
    AddMetrics(comparison.sections, &report);
    report.tables.back().in_text = !comparison.IsAgainstDesign();
    AddMetrics(comparison.surfaces, &report);
  }
  DropRoundingErrors(&report);
  return report;
}

MetricTable* TableOf(const MetricTable& like, MetricsReport* report) {
  const auto it = std::find_if(report->tables.begin(), report->tables.end(),
                               [&](const MetricTable& table) { return table.name == like.name; });
  if (it != report->tables.end()) return &*it;
  report->tables.push_back({like.name, like.in_text, {}});
  return &report->tables.back();
}

std::string NameOfShape(const std::string& path) {
  namespace fs = std::filesystem;
  fs::path folder = AbsoluteFolder(path);
  const std::string file = folder.filename().string();
  if (file == "shape.csv") folder = folder.parent_path();
  if (folder.filename() == "shape" && folder.parent_path().has_filename()) {
    folder = folder.parent_path();
  }
  return folder.has_filename() ? folder.filename().string() : file;
}

// A comparison of the markers alone; surfaces are added later.
Comparison WithoutSurfaces(const std::string& name, ShapeDeviation deviation,
                           const Layout& layout) {
  Comparison comparison;
  comparison.name = name;
  comparison.deviation = std::move(deviation);
  comparison.has_layout = layout.HasMarkers();
  return comparison;
}

}  // namespace

Comparison Compare(const std::string& name, const UncertainShape& shape,
                   const SeriesReference& reference, const Layout& layout,
                   const ComparisonOptions& options) {
  const auto& [uncertain, surfaces] = reference;
  Comparison comparison = WithoutSurfaces(
      name, CompareWithShape(shape, uncertain, layout, options.alignment, options.part), layout);
  if (!comparison.has_layout) return comparison;
  const Alignment& alignment = comparison.deviation.alignment;
  const ShapeSurfaces of_shape(comparison.deviation.aligned_shape);
  comparison.surfaces = CompareSurfaces(of_shape, surfaces, layout, options.part, options.edge);
  if (options.with_deflections) {
    comparison.deflections =
        ComputeDeflections(alignment, {of_shape, shape.covariance},
                           {surfaces, uncertain.covariance}, layout, options.grid, options.part);
  }
  comparison.sections = CompareSections(shape, uncertain, alignment, layout, options.part);
  return comparison;
}

Comparison Compare(const std::string& name, const UncertainShape& shape,
                   const MeshDistance& reference, const Layout& layout,
                   const ComparisonOptions& options) {
  Comparison comparison =
      WithoutSurfaces(name,
                      CompareWithMesh(shape, reference, layout, options.alignment, options.part,
                                      options.edge, options.surface_sigma_m),
                      layout);
  if (!comparison.has_layout) return comparison;
  const ShapeSurfaces of_shape(comparison.deviation.aligned_shape);
  comparison.surfaces = CompareSurfaces(of_shape, reference, layout, options.part, options.edge);
  if (options.with_deflections) {
    comparison.deflections =
        ComputeDeflections(comparison.deviation, {of_shape, shape.covariance}, reference, layout,
                           options.grid, options.part, options.edge);
  }
  comparison.sections = CompareSectionsOfDesign(shape, comparison.deviation, layout, options.part);
  return comparison;
}

MetricsReport MakeComparisonReport(const std::vector<Comparison>& series) {
  if (series.size() == 1) return ReportOf(series.front());
  MetricsReport together;
  together.tables.push_back({"shapes", true, {}});
  for (const Comparison& comparison : series) {
    MetricsReport report = ReportOf(comparison);
    Metrics row = {{"shape", comparison.name}};
    row.insert(row.end(), report.metrics.begin(), report.metrics.end());
    together.tables.front().rows.push_back(std::move(row));
    for (MetricTable& table : report.tables) {
      MetricTable* all = TableOf(table, &together);
      for (Metrics& figures : table.rows) {
        figures.insert(figures.begin(), {"shape", comparison.name});
        all->rows.push_back(std::move(figures));
      }
    }
  }
  return together;
}

std::vector<std::string> NamesOfShapes(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (const std::string& path : paths) {
    const std::string name = NameOfShape(path);
    std::string unique = name;
    for (int i = 2; std::count(names.begin(), names.end(), unique) > 0; ++i) {
      unique = fmt::format("{} ({})", name, i);
    }
    names.push_back(unique);
  }
  return names;
}

}  // namespace velamap
