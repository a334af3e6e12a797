// What goes with a surface as CSV: its residuals out, the sail's edges in.

#pragma once

#include <iosfwd>
#include <string>

#include "exporters/sail/surface.h"
#include "exporters/sail/surface_input.h"

namespace velamap {

// Header marker_id,line,u,v,distance,beyond_edge,is_used; lengths in m, one row a marker of the
// part, by id. As SurfaceResidual has them.
void WriteSurfaceResidualsCsv(const FittedSurface& surface, std::ostream& out);

// Header edge,x,y,z; edge is luff, leech, foot or head, points in m, luff and leech from foot to
// head, foot and head from luff to leech. Throws InputError that names file, line and column:
// another header or edge, a coordinate that is no finite number, an edge of a single point.
SurfaceEdges ReadSurfaceEdges(std::istream& in, const std::string& name);
SurfaceEdges ReadSurfaceEdges(const std::string& path);

}  // namespace velamap
