// shape.csv: the result for machines. Header
// marker_id,corner,x,y,z,sigma_x,sigma_y,sigma_z,num_frames,part
// corner 0 = centre, then 1..4; metres; classic locale, the shortest digits (17 at most) that read
// back to the same double; sigmas empty where unknown. A line `# frame ...` may stand before it.

#pragma once

#include <iosfwd>
#include <string>

#include "exporters/shape/marker_shape.h"

namespace velamap {

// `frame` says in words what frame the shape is in; empty: no such line.
void WriteShapeCsv(const MarkerShape& shape, std::ostream& out, const std::string& frame = "");

// Rows may come in any order; a centre that is left out is computed. Throws InputError that names
// file, line and column: another header, a value that is no number or out of range, a corner twice,
// a marker in two parts, a centre without its corners or more than 1 mm off their mean, no row.
MarkerShape ReadShapeCsv(std::istream& in, const std::string& name);
MarkerShape ReadShapeCsv(const std::string& path);

}  // namespace velamap
