#include "exporters/shape_exporter.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "exporters/datum/known_points_report.h"
#include "exporters/exchange/alicevision_scene.h"
#include "exporters/exchange/metashape_markers.h"
#include "exporters/formats/float_step.h"
#include "exporters/formats/shape_csv.h"
#include "exporters/formats/shape_ply.h"
#include "exporters/sail/sail_metrics.h"
#include "exporters/scale/metric_shape.h"
#include "exporters/scale/scale_audit_report.h"
#include "exporters/scale/scale_csv.h"
#include "exporters/shape/sail_lines.h"
#include "exporters/shape/shape_transform.h"
#include "exporters/shape_report.h"
#include "importer/base/atomic_output.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "importer/base/replacement.h"
#include "importer/geometry/units.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/model_io.h"
#include "reconstruct/model/reprojection.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

// The absolute path without dots and a trailing slash; empty for an empty path.
fs::path OutputFolder(const std::string& path) {
  return path.empty() ? fs::path() : AbsoluteFolder(path);
}

struct OutputFolders {
  fs::path model, shape;  // empty for none
};

OutputFolders CheckedFolders(const ShapeExporterOptions& options) {
  OutputFolders folders{OutputFolder(options.model_output_path),
                        OutputFolder(options.shape_output_path)};
  std::vector<UsedPath> outputs;
  if (!folders.model.empty()) outputs.push_back({"folder of the model", folders.model, true});
  if (!folders.shape.empty()) outputs.push_back({"folder of the shape", folders.shape, true});
  CheckOutputs({}, outputs);
  return folders;
}

const PointCovariance* CovarianceOf(const ShapeExportReport& report) {
  return report.uncertainty ? &report.uncertainty->points : nullptr;
}

MetricsReport MetricsOf(const ShapeExportReport& report) {
  MetricsReport metrics;
  AddMetrics(report.frame, &metrics);
  AddMetrics(report.known_points, &metrics);
  AddMetrics(report.metrics, &metrics);
  AddMetrics(report.model_metrics, &metrics);
  AddMetrics(report.scale, &metrics);
  AddMetrics(report.audit, &metrics);
  if (report.uncertainty) AddMetrics(*report.uncertainty, &metrics);
  const PointCovariance* covariance = CovarianceOf(report);
  AddMetrics(FitPartPlanes(report.shape, covariance), &metrics, covariance);
  AddMetrics(report.sail, &metrics);
  AddMetrics(report.freeform, &metrics);
  return metrics;
}

void WriteShapeFiles(const ShapeExportReport& report, const ShapeExporterOptions& options,
                     const Verdict* verdict, const fs::path& folder) {
  const PlyFormat format = options.files.Ply();
  const std::string frame = FrameText(report.frame);
  WriteFile(folder / "shape.csv", [&](std::ostream& out) { WriteShapeCsv(report.shape, out); });
  WriteFile(folder / "shape.ply", [&](std::ostream& out) {
    WritePointsPly(report.shape, report.metric_model, format, out, frame);
  });
  WriteFile(folder / "markers.ply",
            [&](std::ostream& out) { WriteMarkersPly(report.shape, format, out, frame); });
  WriteFile(folder / "scale.csv", [&](std::ostream& out) { WriteScaleCsv(report.scale, out); });
  const MetricsReport metrics = MetricsOf(report);
  WriteFile(folder / "metrics.csv", [&](std::ostream& out) { WriteMetricsCsv(metrics, out); });
  WriteFile(folder / "metrics.json", [&](std::ostream& out) { WriteMetricsJson(metrics, out); });
  if (options.metashape) {
    WriteFile(folder / "metashape_markers.xml",
              [&](std::ostream& out) { WriteMetashapeMarkers(report.metric_model, out); });
    WriteFile(folder / "metashape_reference.csv",
              [&](std::ostream& out) { WriteMetashapeReference(report.shape, out); });
  }
  if (options.alicevision) {
    WriteFile(folder / "alicevision.sfm",
              [&](std::ostream& out) { WriteAliceVisionScene(report.metric_model, out); });
  }
  WriteSailFiles(report.sail, report.shape, report.frame, options.files, folder);
  WriteFreeformFiles(report.freeform, report.frame, options.files.unit, format, folder);
  // The last one, because it lists the others.
  std::map<std::string, std::string> part_of_stem;
  for (const PartSurface& part : report.freeform.surfaces) part_of_stem[part.file_stem] = part.part;
  const DescribedFiles described = DescribeShapeFiles(folder, options.files.unit, part_of_stem);
  WriteFile(folder / "shape.json", [&](std::ostream& out) {
    WriteShapeJson(report.frame, report.metric_model, report.metrics.num_markers, options.origin,
                   verdict, described, out);
  });
}

std::map<int, double> ScalesOf(const ScaleAudit& audit) {
  std::map<int, double> m_per_unit_of;
  for (const MarkerScale& marker : audit.markers) {
    m_per_unit_of[marker.marker_id] = 1.0 + marker.deviation;
  }
  return m_per_unit_of;
}

// Moves the metric model and its uncertainty into the chosen frame.
void MoveIntoFrame(const Layout& layout, const std::optional<FrameChoice>& choice,
                   ShapeExportReport* report) {
  const MarkerShape shape = ShapeFromModel(report->metric_model, layout);
  report->known_points = FitKnownPoints(shape, layout, CovarianceOf(*report),
                                        report->scale.relative_sigma.value_or(0.0));
  report->frame = ChooseFrame(shape, layout, choice, FrameOfKnownPoints(report->known_points));
  const Rigid3& frame_from_shape = report->frame.frame_from_shape;
  TransformModel({1.0, frame_from_shape.rotation, frame_from_shape.translation},
                 &report->metric_model);
  if (report->uncertainty) {
    report->uncertainty->points =
        RotateCovariance(frame_from_shape.rotation, report->uncertainty->points);
  }
}

// The step of the coarsest STL file, see CoarseFloatStep_m().
std::optional<double> CoarsestStlStep_m(const ShapeExportReport& report) {
  std::optional<double> coarsest_m;
  for (const SailSurface& surface : report.sail.surfaces) {
    coarsest_m = std::max(coarsest_m, CoarseFloatStep_m(surface.mesh.vertices_m));
  }
  for (const PartSurface& part : report.freeform.surfaces) {
    coarsest_m = std::max(coarsest_m, CoarseFloatStep_m(part.surface.mesh.vertices_m));
  }
  return coarsest_m;
}

std::exception_ptr FirstSurfaceError(const ShapeExportReport& report) {
  return report.sail.surface_error ? report.sail.surface_error : report.freeform.surface_error;
}

bool HoldsResult(const fs::path& output) {
  if (output.empty() || !Exists(output)) return false;
  return !IsFolder(output) || !FolderEntries(output).empty();
}

}  // namespace

void ShapeExportReport::ThrowSurfaceErrorBeforeReplacing(
    const std::vector<fs::path>& outputs) const {
  const std::exception_ptr error = FirstSurfaceError(*this);
  if (!error || std::none_of(outputs.begin(), outputs.end(), HoldsResult)) return;
  LogInfo("no surface, so the earlier result stays as it was");
  std::rethrow_exception(error);
}

void ShapeExportReport::ThrowSurfaceError() const {
  const std::exception_ptr error = FirstSurfaceError(*this);
  if (!error) return;
  LogInfo("everything but the surface is written");
  std::rethrow_exception(error);
}

ShapeExportReport MeasureShape(const Model& model, const Layout& layout,
                               const std::optional<FrameChoice>& frame, ScaleMethod scale_by,
                               const AdjustmentUncertainty* uncertainty) {
  ShapeExportReport report;
  report.metric_model = model;
  if (uncertainty != nullptr) {
    report.uncertainty = *uncertainty;
  } else {
    report.scale = EstimateScale(model, layout, scale_by);
    ScaleModel(report.scale, &report.metric_model);
  }
  UpdatePointErrors(&report.metric_model);
  MoveIntoFrame(layout, frame, &report);
  const AdjustmentUncertainty* in_frame = report.uncertainty ? &*report.uncertainty : nullptr;
  const PointCovariance* covariance = CovarianceOf(report);
  report.shape = ShapeFromModel(report.metric_model, layout, covariance);
  report.audit = AuditScale(report.shape, layout, &report.metric_model, in_frame);
  if (in_frame != nullptr) report.scale = MetricScale(ScalesOf(report.audit), *in_frame);
  report.metrics = ComputeShapeMetrics(report.shape, layout, covariance);
  report.model_metrics = ComputeModelMetrics(report.metric_model, MarkerIds(layout));
  return report;
}

std::vector<std::string> FrameWarnings(const ShapeExportReport& report, const Layout& layout,
                                       bool writes_files) {
  std::vector<std::string> warnings;
  // Known points distinguish up from down by themselves.
  const FrameAttempt measured = FrameOfKnownPoints(report.known_points);
  const bool is_measured = measured.frame && measured.frame->name == report.frame.name;
  const std::string doubt = is_measured ? "" : DoubtAboutSailUp(report.shape, layout);
  if (!doubt.empty()) warnings.push_back(doubt);
  const std::optional<double> step_m = CoarsestStlStep_m(report);
  if (writes_files && step_m) {
    warnings.push_back(fmt::format(
        "the frame is so far from the object that STL files, which hold 32-bit floats, have steps "
        "of {:.3g} mm; give known_points from an origin near the object, or use the STEP, PLY or "
        "OBJ files",
        kMmPerM * *step_m));
  }
  return warnings;
}

ShapeExportReport ComputeShape(const Model& model, const Layout& layout,
                               const ShapeExporterOptions& options,
                               const AdjustmentUncertainty* uncertainty) {
  CheckedFolders(options);
  options.sail.Check();
  options.files.grid.Check();
  CheckFrameChoice(options.frame, layout);
  ShapeExportReport report =
      MeasureShape(model, layout, options.frame, options.scale_by, uncertainty);
  const PointCovariance* covariance = CovarianceOf(report);
  report.sail = ComputeSail(report.shape, report.frame, layout, covariance, options.sail);
  report.freeform =
      ComputeFreeform(report.shape, layout, covariance, options.sail.mesh, options.num_threads);
  const bool writes_files = !options.shape_output_path.empty();
  for (const std::string& warning : FrameWarnings(report, layout, writes_files)) {
    LogWarning(warning);
  }
  return report;
}

void WriteShape(const ShapeExportReport& report, const ShapeExporterOptions& options,
                const Verdict* verdict) {
  const OutputFolders folders = CheckedFolders(options);
  std::optional<AtomicFolder> shape_folder;
  if (!folders.shape.empty()) {
    shape_folder.emplace(folders.shape);
    WriteShapeFiles(report, options, verdict, shape_folder->TemporaryPath());
  }
  if (!folders.model.empty()) {
    WriteModel(report.metric_model, folders.model.string(), ModelFormat::kBinaryAndText,
               [&](const std::string& folder) {
                 if (!report.uncertainty) return;
                 WriteUncertainty(*report.uncertainty, report.metric_model, folder);
               });
  }
  // Committed last, so that an error while writing the model keeps the old shape beside the old
  // model.
  if (shape_folder) shape_folder->Commit();
}

}  // namespace velamap
