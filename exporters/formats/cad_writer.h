// Spline surfaces as STEP (AP214) and IGES (5.3), through Open CASCADE, which only this file's and
// cad_reader's sources include. Unit mm, in the coordinates and in the header. One face; poles and
// knots as they are, no approximation. The files carry no time of day: same surface, same bytes.
//
// Not to be called from two threads at a time wishing for speed: Open CASCADE keeps its settings in
// globals, so a lock lets one call through.

#pragma once

#include <iosfwd>
#include <string>

#include "exporters/formats/surface_spline.h"

namespace velamap {

// `name` becomes the product's name (of the part). Throws std::logic_error if Open CASCADE refuses.
void WriteStep(const SplineSurface& surface, const std::string& name, std::ostream& out);
void WriteIges(const SplineSurface& surface, const std::string& name, std::ostream& out);

}  // namespace velamap
