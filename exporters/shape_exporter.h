// The room's door: a bundle-adjusted model and the marker sizes in, metric files out.

#pragma once

#include <string>

#include "exporters/metric_scale.h"
#include "exporters/model_metrics.h"
#include "exporters/scale_audit.h"
#include "exporters/shape_metrics.h"
#include "importer/layout.h"
#include "reconstruct/adjustment_uncertainty.h"
#include "reconstruct/model.h"

namespace velamap {

struct ShapeExporterOptions {
  std::string model_output_path;  // folder of the metric model, binary and text; empty: not written
  std::string shape_output_path;  // folder of shape.csv, shape.ply, ...; empty: not written
  bool ascii_ply = false;
};

struct ShapeExportReport {
  ScaleEstimate scale;
  MarkerShape shape;
  ShapeMetrics metrics;
  ModelMetrics model_metrics;
  ScaleAudit audit;
};

// Writes shape.csv, shape.ply (points), markers.ply (squares), scale.csv, metrics.csv and
// metrics.json into shape_output_path, and the metric COLMAP model with true point errors, each
// folder to a temporary sibling that is renamed when whole. A folder that exists is replaced if it
// holds nothing but files of these names.
//
// With `uncertainty` (ReadUncertainty of the model's folder) the model is metric: it is not scaled,
// all that is reported gets its sigma, and the metric model's folder keeps the uncertainty.
// Without, the model is scaled by the markers' sides. Throws DataError (no marker gives a scale, no
// image), InputError (unwritable output, a folder with other files, one folder inside the other).
ShapeExportReport ExportShape(const Model& model, const Layout& layout,
                              const ShapeExporterOptions& options,
                              const AdjustmentUncertainty* uncertainty = nullptr);

}  // namespace velamap
