// The room's door: a bundle-adjusted model and the marker sizes in, metric files out.

#pragma once

#include <string>

#include "exporters/metric_scale.h"
#include "exporters/shape_metrics.h"
#include "importer/layout.h"
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
  Statistics reprojection_error_px;
};

// Writes shape.csv, shape.ply (points) and markers.ply (squares) into shape_output_path and the
// metric COLMAP model, each folder to a temporary sibling that is renamed when whole.
// Throws DataError (no marker gives a scale), InputError (unwritable output).
ShapeExportReport ExportShape(const Model& model, const Layout& layout,
                              const ShapeExporterOptions& options);

}  // namespace velamap
