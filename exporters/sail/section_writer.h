// Section tables: sections.csv, sections.json and section_profiles.csv. The columns stand in
// README.md of this room. Classic locale, shortest digits that read back to the same double; what
// is not known is empty (CSV) or not there (JSON). The CSV files begin with # lines that name the
// frame.

#pragma once

#include <iosfwd>

#include "exporters/sail/section.h"
#include "exporters/shape/shape_frame.h"

namespace velamap {

constexpr int kNumProfilePoints = 101;  // of the files

// One row a section, from the lowest up; then one with a reason for each that is missing.
void WriteSectionsCsv(const SectionReport& report, const ShapeFrame& frame, std::ostream& out);

// An object: frame, twist_reference, notes, sections (with markers and residuals), missing.
void WriteSectionsJson(const SectionReport& report, const ShapeFrame& frame, std::ostream& out);

// Points of the curves, then the markers of each: marker_id is empty for a point of a curve.
void WriteSectionProfilesCsv(const SectionReport& report, const ShapeFrame& frame,
                             std::ostream& out);

}  // namespace velamap
