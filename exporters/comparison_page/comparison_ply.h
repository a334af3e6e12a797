// The compared markers and surfaces as PLY, coloured by their signed distance from the reference.
//
// Both files are ASCII, in the frame of the reference, in m: opened together with the reference,
// they lie on it. Points outside the edge of the reference are grey. `color_limit_m` is the largest
// distance by default. Comments in the header name the limit, the sign and the alignment.

#pragma once

#include <iosfwd>
#include <optional>

#include <Eigen/Core>

#include "exporters/compare/shape_deviation.h"
#include "exporters/compare/surface_comparison.h"

namespace velamap {

// Blue, white and red (0 to 255) for -limit, 0 and +limit, clamped beyond; grey for an unknown
// distance; white for a limit of 0. The scale is ColorBrewer's RdBu, which suits all kinds of
// colour vision.
Eigen::Array3d DivergingColor(const std::optional<double>& distance_m, double limit_m);

// One quadrilateral per compared marker: four vertices (corners 1..4) with double x y z, float nx
// ny nz, uchar red green blue, float distance (m, of the marker), float sigma (m, only if all
// markers have one), int marker_id, int corner; faces with vertex_indices and int marker_id.
void WriteComparisonPly(const ShapeDeviation& deviation, std::optional<double> color_limit_m,
                        std::ostream& out);

// The meshes of all parts: double x y z, uchar red green blue, float distance (m, nan where it is
// unknown), and triangles.
void WriteComparisonSurfacePly(const SurfaceComparison& comparison,
                               std::optional<double> color_limit_m, std::ostream& out);

}  // namespace velamap
