// Frame, sections and surfaces for the report.

#pragma once

#include <optional>
#include <vector>

#include "exporters/freeform/freeform_shape.h"
#include "exporters/report/report_data.h"
#include "exporters/sail/sail_shape.h"
#include "exporters/shape/shape_frame.h"
#include "reconstruct/model/model.h"

namespace velamap {

// The front view has the leveled viewing direction of the central camera. Nothing for a frame
// without an up direction.
std::optional<ReportFrame> MakeReportFrame(const ShapeFrame& frame, const Model& metric_model);

std::vector<ReportSection> MakeReportSections(const SectionReport& sections);

// The parts whose rig is at least partly known.
std::vector<RigNumbers> MakeReportRigs(const SectionReport& sections);

// The surfaces of sails, with about 10 000 triangles each, then those of parts without lines. A
// surface with too many triangles for the page is listed without them.
std::vector<ReportSurface> MakeReportSurfaces(const SailShape& sail, const FreeformShape& freeform);

}  // namespace velamap
