// Section tables: sections.csv, sections.json and section_profiles.csv. exporters/formats/README.md
// lists the columns. Numbers have the fewest digits that read back to the same double; an unknown
// number is an empty field (CSV) or has no key (JSON).

#pragma once

#include <iosfwd>

#include "exporters/sail/section.h"
#include "exporters/shape/shape_frame.h"

namespace velamap {

constexpr int kNumProfilePoints = 101;  // per section in all files

// One row per section from the lowest up, then one row per missing section with the reason.
void WriteSectionsCsv(const SectionReport& report, std::ostream& out);

// One object: frame, notes, sections (with markers and residuals), rigs (with reference_section,
// twist_reference, up_reference and aft_reference by part), missing.
void WriteSectionsJson(const SectionReport& report, const ShapeFrame& frame, std::ostream& out);

// For each section the points of the curve, with an empty marker_id, then the markers.
void WriteSectionProfilesCsv(const SectionReport& report, std::ostream& out);

}  // namespace velamap
