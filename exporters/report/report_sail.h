// What the report shows of frame, sections and surfaces, from the values that the files hold.

#pragma once

#include <optional>
#include <vector>

#include "exporters/report/report_data.h"
#include "exporters/sail/sail_shape.h"
#include "exporters/shape/shape_frame.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Nothing for a frame that knows no up: the central camera's then is the one to take. "Front" looks
// as the central camera does, levelled.
std::optional<ReportFrame> MakeReportFrame(const ShapeFrame& frame, const Model& metric_model);

std::vector<ReportSection> MakeReportSections(const SectionReport& sections);

// All surfaces as one, in at most about 10 000 triangles each; nothing without one.
std::optional<ReportSurface> MakeReportSurface(const SailShape& sail);

}  // namespace velamap
