// shape.csv: the result for machines. Header
// marker_id,corner,x,y,z,sigma_x,sigma_y,sigma_z,num_frames,part
// corner 0 = centre, then 1..4; metres; classic locale, 17 digits; sigmas empty where unknown.

#pragma once

#include <iosfwd>
#include <string>

#include "exporters/marker_shape.h"

namespace velamap {

void WriteShapeCsv(const MarkerShape& shape, std::ostream& out);

// Throws InputError that names file, line and column.
MarkerShape ReadShapeCsv(std::istream& in, const std::string& name);
MarkerShape ReadShapeCsv(const std::string& path);

}  // namespace velamap
