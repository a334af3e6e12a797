// Luff and leech of a part as the layout gives them, and how far they are from the ends of its
// lines.

#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "exporters/curve/space_curve.h"
#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"

namespace velamap {

struct SideEdge {
  ClothEdge in_layout;
  // Through the points along the edge that the layout names and the shape has, from the lowest up.
  std::optional<SpaceCurve> curve;
};

struct SideEdges {
  SideEdge luff, leech;
};

SideEdges FindSideEdges(const MarkerShape& shape, const LayoutPart& part,
                        const Eigen::Vector3d& up);

// The end of the curve through a line of markers.
struct CurveEnd {
  std::size_t line_idx = 0;         // among the horizontal lines of the part
  bool is_at_outer_marker = false;  // that the layout lists; not if the shape lacks it
  Eigen::Vector3d x_in_shape_m;
  Eigen::Vector3d outwards;  // unit tangent
};

// From the end along the cloth to the edge, m; nothing if the layout does not give the edge, or
// gives its distance from a marker that the shape lacks, or if the curve of the edge does not pass
// in front of the end.
std::optional<double> DistanceToEdge(const SideEdge& edge, const CurveEnd& end,
                                     const Eigen::Vector3d& up);

}  // namespace velamap
