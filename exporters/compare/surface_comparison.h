// How far the smooth surface of a sail is from that of another shape, or from a design, all over.

#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "exporters/compare/mesh_distance.h"
#include "exporters/formats/mesh_triangles.h"
#include "exporters/shape/marker_shape.h"
#include "importer/base/statistics.h"
#include "importer/layout/layout.h"

namespace velamap {

struct SurfaceDeviation {
  std::string part;
  TriangleMesh mesh;  // of the compared shape, in the reference's frame
  // One a vertex: along the normal of the reference, positive on the side to which it looks;
  // nothing where the vertex lies beside the reference.
  std::vector<std::optional<double>> distance_m;
  Statistics statistics_m;  // of those that are known
};

struct SurfaceComparison {
  std::vector<SurfaceDeviation> parts;  // with lines, in the layout's order
  std::vector<std::string> notes;       // parts without a surface and why
};

// The surfaces are those of FitSurface() through each part with horizontal lines, the mesh is that
// of shape_exporter. `aligned_shape` is in the reference's frame (ShapeDeviation::aligned_shape).
// An empty `part` takes all.
SurfaceComparison CompareSurfaces(const MarkerShape& aligned_shape, const MarkerShape& reference,
                                  const Layout& layout, const std::string& part = "");
SurfaceComparison CompareSurfaces(const MarkerShape& aligned_shape, const MeshDistance& reference,
                                  const Layout& layout, const std::string& part = "");

// Largest known distance without sign, m.
double LargestDistance(const SurfaceComparison& comparison);

// ASCII PLY of all parts: double x y z, uchar red green blue (DivergingColor), float distance (m;
// nan where it is not known) and triangles; reference's frame, m. `color_limit_m`: nothing takes
// the largest distance.
void WriteComparisonSurfacePly(const SurfaceComparison& comparison,
                               std::optional<double> color_limit_m, std::ostream& out);

}  // namespace velamap
