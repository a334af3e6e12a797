// shape.csv, the result for other programs. Header
//   marker_id,corner,x,y,z,sigma_x,sigma_y,sigma_z,num_frames,part
// Corner 0 is the centre, 1..4 are the corners; lengths in m, with the fewest digits that read back
// to the same double; unknown sigmas are empty.

#pragma once

#include <iosfwd>
#include <string>

#include "exporters/shape/marker_shape.h"

namespace velamap {

void WriteShapeCsv(const MarkerShape& shape, std::ostream& out);

// Rows may be in any order; missing centres are computed; empty lines and lines that start with #,
// which velamap 0.1.0 wrote before the header, are skipped. Throws InputError naming file, line and
// column for another header, a value that is not a number or is out of range, a duplicate corner, a
// marker in two parts, a centre without its corners or more than 1 mm from their mean, or no row.
MarkerShape ReadShapeCsv(std::istream& in, const std::string& name);
MarkerShape ReadShapeCsv(const std::string& path);

}  // namespace velamap
