// Writes spline surfaces as STEP (AP214) and IGES (5.3) with Open CASCADE. Coordinates and header
// are in mm. The surface becomes one face with its poles and knots, without approximation. The
// files have no time stamp, so that the same surface gives the same bytes.
//
// Calls are serialized, because Open CASCADE keeps its settings in global variables.

#pragma once

#include <iosfwd>
#include <string>

#include "exporters/formats/surface_spline.h"

namespace velamap {

// `name`, of the part, becomes the name of the product. Throws std::logic_error if Open CASCADE
// fails.
void WriteStep(const SplineSurface& surface, const std::string& name, std::ostream& out);
void WriteIges(const SplineSurface& surface, const std::string& name, std::ostream& out);

}  // namespace velamap
