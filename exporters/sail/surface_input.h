// The marker centres that a surface is laid through, by their lines.

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
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();  // its centre
  std::optional<double> sigma_m;                           // of each coordinate
};

// A horizontal line of the layout from luff to leech. A marker that the layout names and the shape
// lacks keeps its place, so that gaps are known.
struct SurfaceLine {
  std::string name;
  std::vector<std::optional<SurfaceMarker>> markers;
};

struct SurfaceInput {
  std::vector<SurfaceLine> lines;      // from foot to head
  std::vector<SurfaceMarker> markers;  // of the part, on no horizontal line
};

// Edges of the sail, measured or from the design, as polylines in the shape frame (m): luff and
// leech from foot to head, foot and head from luff to leech. An empty one is not known.
struct SurfaceEdges {
  std::vector<Eigen::Vector3d> luff, leech, foot, head;
};

// The horizontal lines of `part`, in the layout's order, and its other markers: whole markers only.
// A marker's sigma is the root mean square of the three of its centre. With the joint covariance it
// is that of the marker's own noise (the covariance's blocks): what all markers have in common,
// such as the scale, bends no surface.
SurfaceInput CollectSurfaceInput(const MarkerShape& shape, const LayoutPart& part,
                                 const PointCovariance* covariance = nullptr);

}  // namespace velamap
