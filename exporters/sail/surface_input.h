// The marker centers that a surface is fitted to, by their lines.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

struct SurfaceMarker {
  int marker_id = 0;
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();  // of the center
  std::optional<double> sigma_m;                           // of each coordinate
};

// A horizontal line of the layout from luff to leech. A marker that the shape lacks keeps its place
// in the list, so that gaps are known.
struct SurfaceLine {
  std::string name;
  std::vector<std::optional<SurfaceMarker>> markers;
};

struct SurfaceInput {
  std::vector<SurfaceLine> lines;      // from foot to head
  std::vector<SurfaceMarker> markers;  // markers of the part on no horizontal line
};

// Edges of the sail, measured or from the design, as polylines in the shape frame (m): luff and
// leech from foot to head, foot and head from luff to leech. An unknown edge is empty.
struct SurfaceEdges {
  std::vector<Eigen::Vector3d> luff, leech, foot, head;
};

// Collects the horizontal lines of `part` in the order of the layout, and its other markers, whole
// markers only. The sigma of a marker is the root mean square of the three sigmas of its center.
// From a joint covariance it takes the noise of the marker alone (the blocks), because errors that
// all markers share, such as the scale, do not bend the surface.
SurfaceInput CollectSurfaceInput(const MarkerShape& shape, const LayoutPart& part,
                                 const PointCovariance* covariance = nullptr);

}  // namespace velamap
