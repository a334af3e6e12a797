// The residuals of a surface as CSV.

#pragma once

#include <iosfwd>

#include "exporters/surface.h"

namespace velamap {

// Header marker_id,line,u,v,distance,beyond_edge,is_used; lengths in m, one row a marker of the
// part, by id. As SurfaceResidual has them.
void WriteSurfaceResidualsCsv(const FittedSurface& surface, std::ostream& out);

}  // namespace velamap
