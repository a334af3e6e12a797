// Distances of the smooth surface of a sail from the surface of another shape or from a design.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/compare/shape_surfaces.h"
#include "exporters/design/mesh_distance.h"
#include "exporters/formats/mesh_triangles.h"
#include "importer/base/statistics.h"
#include "importer/layout/layout.h"

namespace velamap {

struct SurfaceDeviation {
  std::string part;
  TriangleMesh mesh;  // of the compared shape, in the reference's frame
  // One per vertex: along the normal of the reference, positive on the side to which it points;
  // nothing if the vertex is more than EdgeOptions::tolerance_mm beyond the edge of the
  // reference.
  std::vector<std::optional<double>> distance_m;
  Statistics statistics_m;  // of the known distances
};

struct SurfaceComparison {
  std::vector<SurfaceDeviation> parts;  // those with lines, in the order of the layout
  std::vector<std::string> notes;       // parts without a surface, with the reason
};

// Compares the surface through each part with horizontal lines, at the vertices of the mesh that
// shape_exporter writes. `aligned_shape` is in the frame of the reference
// (ShapeDeviation::aligned_shape). Between two shapes, distances are positive on the side to which
// the markers of the reference face. An empty `part` means all parts.
SurfaceComparison CompareSurfaces(const ShapeSurfaces& aligned_shape,
                                  const ShapeSurfaces& reference, const Layout& layout,
                                  const std::string& part = "", const EdgeOptions& edge = {});
SurfaceComparison CompareSurfaces(const ShapeSurfaces& aligned_shape, const MeshDistance& reference,
                                  const Layout& layout, const std::string& part = "",
                                  const EdgeOptions& edge = {});

// The largest absolute value of the known distances, m.
double LargestDistance(const SurfaceComparison& comparison);

}  // namespace velamap
