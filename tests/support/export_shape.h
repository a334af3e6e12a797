// A complete export, for tests that check its files.

#pragma once

#include "exporters/shape_exporter.h"

namespace velamap {

// ComputeShape() and WriteShape() without a verdict.
inline ShapeExportReport ExportShape(const Model& model, const Layout& layout,
                                     const ShapeExporterOptions& options,
                                     const AdjustmentUncertainty* uncertainty = nullptr) {
  ShapeExportReport report = ComputeShape(model, layout, options, uncertainty);
  WriteShape(report, options, nullptr);
  return report;
}

}  // namespace velamap
