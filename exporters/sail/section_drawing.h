// Drawings of sections: DXF for CAD programs, SVG for reading.
//
// The DXF is ASCII of AutoCAD R12, which every program reads, with the unit in $INSUNITS. It needs
// three kinds of entities only. Of the C++ libraries in Debian, libdxflib and libdxfrw are under
// the GPL, which velamap's license does not allow, and dime has had no release since 2011.

#pragma once

#include <iosfwd>

#include "exporters/formats/length_unit.h"
#include "exporters/sail/section.h"
#include "exporters/shape/shape_frame.h"

namespace velamap {

// Sections at their positions in the frame: one 3D polyline per section on its own layer
// (PART_SECTION, with characters that a layer name does not allow replaced by _), and the markers
// as points on layer MARKERS.
void WriteSectionsDxf(const SectionReport& report, const ShapeFrame& frame, LengthUnit unit,
                      std::ostream& stream);

// Profiles of the sections: x along the chord from the luff, y the depth, one below the other from
// the head down; chords on layer CHORDS, names on layer NAMES.
void WriteSectionProfilesDxf(const SectionReport& report, const ShapeFrame& frame, LengthUnit unit,
                             std::ostream& stream);

// The same profiles with their numbers, with one scale for both axes and a scale bar; below them
// the frame, notes, and missing sections with their reasons.
void WriteSectionProfilesSvg(const SectionReport& report, const ShapeFrame& frame,
                             std::ostream& out);

}  // namespace velamap
