// CSV files of a surface: its residuals, and the edges of the sail.

#pragma once

#include <iosfwd>
#include <string>

#include "exporters/surface/surface.h"
#include "exporters/surface/surface_input.h"

namespace velamap {

// Header marker_id,line,u,v,distance,beyond_edge,is_used: the members of SurfaceResidual, one row
// per marker of the part, by id; lengths in m.
void WriteSurfaceResidualsCsv(const FittedSurface& surface, std::ostream& out);

// The root mean square distance of the used markers in such a file, m; 0 without one. Throws
// InputError naming file, line and column for another header or what is not a number.
double ReadSurfaceResidualRms(std::istream& in, const std::string& name);
double ReadSurfaceResidualRms(const std::string& path);

// Header edge,x,y,z,sigma: the edges of the surface, m.
void WriteSurfaceEdgesCsv(const FittedSurface& surface, std::ostream& out);

// Header edge,x,y,z: edge is luff or leech (points from foot to head), foot or head (points from
// luff to leech), coordinates in m. Throws InputError naming file, line and column for another
// header or edge, a coordinate that is not a finite number, or an edge of a single point.
SurfaceEdges ReadSurfaceEdges(std::istream& in, const std::string& name);
SurfaceEdges ReadSurfaceEdges(const std::string& path);

}  // namespace velamap
