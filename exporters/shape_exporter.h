// The room's door: a bundle-adjusted model and the marker sizes in, metric files out.

#pragma once

#include <optional>
#include <string>

#include "exporters/sail/sail_shape.h"
#include "exporters/scale/metric_scale.h"
#include "exporters/scale/model_metrics.h"
#include "exporters/scale/scale_audit.h"
#include "exporters/shape/shape_frame.h"
#include "exporters/shape/shape_metrics.h"
#include "importer/layout/frame_choice.h"
#include "importer/layout/layout.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct ShapeExporterOptions {
  std::string model_output_path;  // folder of the metric model, binary and text; empty: not written
  std::string shape_output_path;  // folder of shape.csv, shape.ply, ...; empty: not written
  bool ascii_ply = false;
  std::optional<FrameChoice> frame;  // nothing: as ChooseFrame() decides
  SailOptions sail;
};

struct ShapeExportReport {
  ScaleEstimate scale;
  ShapeFrame frame;
  Model metric_model;                                // unit m, in `frame`
  std::optional<AdjustmentUncertainty> uncertainty;  // in `frame`
  MarkerShape shape;
  SailShape sail;
  ShapeMetrics metrics;
  ModelMetrics model_metrics;
  ScaleAudit audit;
};

// Writes shape.csv, shape.ply (points), markers.ply (squares), scale.csv, metrics.csv, metrics.json
// and what WriteSailFiles() writes into shape_output_path, and the metric COLMAP model with true
// point errors, each folder to a temporary sibling that is renamed when whole. A folder that exists
// is replaced if it holds nothing but files of these names. All of it is in the chosen frame.
//
// With `uncertainty` (ReadUncertainty of the model's folder) the model is metric: it is not scaled,
// all that is reported gets its sigma, and the metric model's folder keeps the uncertainty.
// Without, the model is scaled by the markers' sides. Throws DataError (no marker gives a scale, no
// image), InputError (unwritable output, a folder with other files, one folder inside the other,
// bad options).
ShapeExportReport ExportShape(const Model& model, const Layout& layout,
                              const ShapeExporterOptions& options,
                              const AdjustmentUncertainty* uncertainty = nullptr);

}  // namespace velamap
