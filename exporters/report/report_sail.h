// Frame, sections, rigs and surfaces for the report.

#pragma once

#include <optional>

#include "exporters/report/report_json.h"
#include "exporters/shape/shape_frame.h"
#include "reconstruct/model/model.h"

namespace velamap {

// The front view has the leveled viewing direction of the central camera. Returns nothing for a
// frame without an up direction.
std::optional<ReportFrame> MakeReportFrame(const ShapeFrame& frame, const Model& metric_model);

// Adds sections, rigs, surfaces, their notes and the design, each only if there is one. Surfaces of
// sails have about 10 000 triangles each. Another surface with too many triangles for the page is
// listed without them.
void AddSail(const ReportInput& input, ReportJsonValue* json);

}  // namespace velamap
