#include "exporters/shape_exporter.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "exporters/metric_shape.h"
#include "exporters/ply_writer.h"
#include "exporters/scale_audit_report.h"
#include "exporters/scale_csv.h"
#include "exporters/shape_csv.h"
#include "exporters/shape_report.h"
#include "importer/atomic_output.h"
#include "importer/error.h"
#include "reconstruct/model_io.h"
#include "reconstruct/reprojection.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

const std::set<std::string> kShapeFiles = {"shape.csv", "shape.ply",   "markers.ply",
                                           "scale.csv", "metrics.csv", "metrics.json"};

bool IsInside(const fs::path& path, const fs::path& folder) {
  const auto [mismatch, unused] =
      std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return mismatch == folder.end();
}

// The path without dots and a slash at its end; empty stays empty.
fs::path OutputFolder(const std::string& path) {
  if (path.empty()) return {};
  const fs::path absolute = fs::absolute(path).lexically_normal();
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

void CheckOutputFolders(const fs::path& model_path, const fs::path& shape_path) {
  if (!model_path.empty()) CheckReplaceableFolder(model_path, ModelFileNames());
  if (!shape_path.empty()) CheckReplaceableFolder(shape_path, kShapeFiles);
  if (model_path.empty() || shape_path.empty()) return;
  if (IsInside(model_path, shape_path) || IsInside(shape_path, model_path)) {
    throw InputError(shape_path.string() + ": the folders of the shape and of the model (" +
                     model_path.string() + ") must not be the same or one inside the other");
  }
}

MetricsReport MetricsOf(const ShapeExportReport& report, const PointCovariance* covariance) {
  MetricsReport metrics;
  AddMetrics(report.metrics, &metrics);
  AddMetrics(report.model_metrics, &metrics);
  AddMetrics(report.scale, &metrics);
  AddMetrics(report.audit, &metrics);
  AddMetrics(FitPartPlanes(report.shape, covariance), &metrics, covariance);
  return metrics;
}

void WriteShapeFiles(const ShapeExportReport& report, const Model& metric_model,
                     const PointCovariance* covariance, bool ascii_ply, const fs::path& folder) {
  const PlyFormat format = ascii_ply ? PlyFormat::kAscii : PlyFormat::kBinaryLittleEndian;
  WriteFile(folder / "shape.csv", [&](std::ostream& out) { WriteShapeCsv(report.shape, out); });
  WriteFile(folder / "shape.ply",
            [&](std::ostream& out) { WritePointsPly(report.shape, metric_model, format, out); });
  WriteFile(folder / "markers.ply",
            [&](std::ostream& out) { WriteMarkersPly(report.shape, format, out); });
  WriteFile(folder / "scale.csv", [&](std::ostream& out) { WriteScaleCsv(report.scale, out); });
  const MetricsReport metrics = MetricsOf(report, covariance);
  WriteFile(folder / "metrics.csv", [&](std::ostream& out) { WriteMetricsCsv(metrics, out); });
  WriteFile(folder / "metrics.json", [&](std::ostream& out) { WriteMetricsJson(metrics, out); });
}

std::map<int, double> ScalesOf(const ScaleAudit& audit) {
  std::map<int, double> m_per_unit_of;
  for (const MarkerScale& marker : audit.markers) {
    m_per_unit_of[marker.marker_id] = 1.0 + marker.deviation;
  }
  return m_per_unit_of;
}

}  // namespace

ShapeExportReport ExportShape(const Model& model, const Layout& layout,
                              const ShapeExporterOptions& options,
                              const AdjustmentUncertainty* uncertainty) {
  const fs::path model_path = OutputFolder(options.model_output_path);
  const fs::path shape_path = OutputFolder(options.shape_output_path);
  CheckOutputFolders(model_path, shape_path);

  const PointCovariance* covariance = uncertainty != nullptr ? &uncertainty->points : nullptr;
  ShapeExportReport report;
  Model metric_model = model;
  if (uncertainty == nullptr) {
    report.scale = EstimateScale(model, layout);
    ScaleModel(report.scale, &metric_model);
  }
  UpdatePointErrors(&metric_model);
  report.shape = ShapeFromModel(metric_model, layout, covariance);
  report.audit = AuditScale(report.shape, layout, &metric_model, uncertainty);
  if (uncertainty != nullptr) report.scale = MetricScale(ScalesOf(report.audit), *uncertainty);
  report.metrics = ComputeShapeMetrics(report.shape, layout, covariance);
  report.model_metrics = ComputeModelMetrics(metric_model, MarkerIds(layout));

  std::optional<AtomicFolder> shape_folder;
  if (!shape_path.empty()) {
    shape_folder.emplace(shape_path);
    WriteShapeFiles(report, metric_model, covariance, options.ascii_ply,
                    shape_folder->TemporaryPath());
  }
  if (!model_path.empty()) {
    WriteModel(metric_model, model_path.string(), ModelFormat::kBinaryAndText,
               [&](const std::string& folder) {
                 if (uncertainty != nullptr) WriteUncertainty(*uncertainty, folder);
               });
  }
  // Last, so that a model that cannot be written leaves the old shape beside the old model.
  if (shape_folder) shape_folder->Commit();
  return report;
}

}  // namespace velamap
