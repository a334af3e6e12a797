// Frame, sections and surfaces for the report.

#pragma once

#include <optional>
#include <vector>

#include "exporters/report/report_data.h"
#include "exporters/sail/sail_shape.h"
#include "exporters/shape/shape_frame.h"
#include "reconstruct/model/model.h"

namespace velamap {

// The front view has the leveled viewing direction of the central camera. Nothing for a frame
// without an up direction.
std::optional<ReportFrame> MakeReportFrame(const ShapeFrame& frame, const Model& metric_model);

std::vector<ReportSection> MakeReportSections(const SectionReport& sections);

// All surfaces as one mesh, with about 10 000 triangles each; nothing without a surface.
std::optional<ReportSurface> MakeReportSurface(const SailShape& sail);

}  // namespace velamap
