// The compared markers, coloured by their signed distance from the reference.

#pragma once

#include <iosfwd>
#include <optional>

#include "exporters/compare/shape_comparison.h"

namespace velamap {

// ASCII PLY in the reference's frame, m, so that it lies on the design when both are opened. One
// quadrilateral a marker that was compared: four vertices (corners 1..4) with double x y z, float
// nx ny nz, uchar red green blue, float distance (m, of the marker), float sigma (m; only if all
// have one), int marker_id, int corner; faces with vertex_indices and int marker_id.
//
// Blue, white, red for -limit, 0, +limit and beyond (ColorBrewer's RdBu, which colour-blind eyes
// tell apart); grey for markers beside the surface. `color_limit_m`: nothing takes the largest
// distance. The comments of the header say limit, sign and alignment.
void WriteComparisonPly(const ShapeDeviation& deviation, std::optional<double> color_limit_m,
                        std::ostream& out);

}  // namespace velamap
