// Entry point of the exporters: takes a bundle-adjusted model and the marker sizes, writes metric
// files.

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "exporters/datum/known_points.h"
#include "exporters/freeform/freeform_shape.h"
#include "exporters/report/verdict.h"
#include "exporters/sail/sail_shape.h"
#include "exporters/scale/metric_scale.h"
#include "exporters/scale/model_metrics.h"
#include "exporters/scale/scale_audit.h"
#include "exporters/shape/shape_frame.h"
#include "exporters/shape/shape_metrics.h"
#include "exporters/shape_json.h"
#include "importer/layout/frame_choice.h"
#include "importer/layout/layout.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct ShapeExporterOptions {
  std::string model_output_path;     // folder of the metric model, binary and text; empty for none
  std::string shape_output_path;     // folder of shape.csv, shape.ply, ...; empty for none
  bool metashape = false;            // also the files of exchange/metashape_markers.h
  bool alicevision = false;          // also the file of exchange/alicevision_scene.h
  std::optional<FrameChoice> frame;  // without it, ChooseFrame() decides
  ScaleMethod scale_by = ScaleMethod::kAgreeing;  // of a model without uncertainty
  SailOptions sail;
  SailFileOptions files;  // the unit also applies to parts without lines
  ShapeOrigin origin;     // for shape.json
  int num_threads = 0;    // 0: one per core; never changes the result
};

struct ShapeExportReport {
  ScaleEstimate scale;
  KnownPointFit known_points;
  ShapeFrame frame;
  Model metric_model;                                // unit m, in `frame`
  std::optional<AdjustmentUncertainty> uncertainty;  // in `frame`
  MarkerShape shape;
  SailShape sail;
  FreeformShape freeform;  // parts without lines
  ShapeMetrics metrics;
  ModelMetrics model_metrics;
  ScaleAudit audit;

  // Both throw the first error of a surface (SailShape::surface_error), if there is one. The shape
  // does not depend on it, so callers ask twice: before they write, and after they have written
  // everything else but printed nothing.
  //
  // The first one throws only if one of the outputs, files or folders, holds an earlier result,
  // which may have the surface that this one lacks. Empty paths are ignored.
  void ThrowSurfaceErrorBeforeReplacing(const std::vector<std::filesystem::path>& outputs) const;
  void ThrowSurfaceError() const;
};

// The metric shape in its frame with its figures, but without sections and surfaces, which take
// most of the time.
//
// With `uncertainty` (ReadUncertainty of the model's folder) the model is metric already: it is not
// scaled, and all figures get their sigmas. Without it, the model is scaled by the sides of the
// markers. Throws DataError without a marker that gives a scale or without an image, and InputError
// for a frame that the markers do not allow.
ShapeExportReport MeasureShape(const Model& model, const Layout& layout,
                               const std::optional<FrameChoice>& frame, ScaleMethod scale_by,
                               const AdjustmentUncertainty* uncertainty = nullptr);

// Doubts about the frame, and about files whose numbers are too coarse in it, one sentence each
// with the remedy. `writes_files`: whether the files of the shape are written.
std::vector<std::string> FrameWarnings(const ShapeExportReport& report, const Layout& layout,
                                       bool writes_files);

// MeasureShape() with sections and surfaces, and FrameWarnings() in the log: all that WriteShape()
// writes with the same options. Throws InputError also for bad options, among them folders that
// WriteShape() would refuse. An option of the surface that the size of the part forbids is left to
// the caller, see ShapeExportReport::ThrowSurfaceErrorBeforeReplacing().
ShapeExportReport ComputeShape(const Model& model, const Layout& layout,
                               const ShapeExporterOptions& options,
                               const AdjustmentUncertainty* uncertainty = nullptr);

// Writes shape.csv, shape.json, shape.ply (points), markers.ply (squares), scale.csv, metrics.csv,
// metrics.json and the files of WriteSailFiles() and WriteFreeformFiles() to shape_output_path, and
// the metric COLMAP model with true point errors and the uncertainty to model_output_path, all in
// the chosen frame. Each folder is written to a temporary sibling and renamed when complete. An
// existing folder is replaced if velamap wrote every file in it (importer/base/replacement.h).
// `verdict` is for shape.json and may be null: it needs the warnings of the log, which the caller
// has. Throws InputError for unwritable output, a folder with other files, one folder inside the
// other, or a model that a format asked for cannot hold.
void WriteShape(const ShapeExportReport& report, const ShapeExporterOptions& options,
                const Verdict* verdict);

}  // namespace velamap
