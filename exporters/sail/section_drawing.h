// Section drawings for CAD and for the eye, in mm.
//
// The DXF is ASCII of AutoCAD R12, the version that every program reads, with $INSUNITS = 4 (mm).
// Of Debian's C++ libraries libdxflib and libdxfrw are under the GPL, which velamap's licence does
// not bear, and dime has had no release since 2011; what is written here is three kinds of entity.

#pragma once

#include <iosfwd>

#include "exporters/sail/section.h"
#include "exporters/shape/shape_frame.h"

namespace velamap {

// Every section where it is in the frame: a 3D polyline a section, each on a layer of its own
// (PART_SECTION, with what a layer's name must not have replaced by _), the markers as points on
// MARKERS.
void WriteSectionsDxf(const SectionReport& report, const ShapeFrame& frame, std::ostream& out);

// Every section as seen along the sail: x along the chord from the luff, y the depth, one below the
// other from the head down; chords on layer CHORDS, names on layer NAMES.
void WriteSectionProfilesDxf(const SectionReport& report, const ShapeFrame& frame,
                             std::ostream& out);

// The same profiles with their numbers, drawn to one scale (both axes), which stands in the
// drawing; missing sections with their reasons, notes and the frame below.
void WriteSectionProfilesSvg(const SectionReport& report, const ShapeFrame& frame,
                             std::ostream& out);

}  // namespace velamap
