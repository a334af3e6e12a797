// The markers that a surface is fitted to, by their lines.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"

namespace velamap {

struct SurfaceMarker {
  int marker_id = 0;
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();  // of the centre, the mean of the corners
  std::optional<double> sigma_m;                           // of each coordinate
  std::vector<Eigen::Vector3d> corners_in_shape_m{};       // 1 to 4; none for a point
  // Of each coordinate of half the vector from the middle of a side to that of the opposite one,
  // which shows how the marker is tilted. Errors that all corners share do not count.
  std::optional<double> tilt_sigma_m{};
};

// A horizontal line of the layout from luff to leech. A marker that the shape lacks keeps its place
// in the list, so that gaps are known.
struct SurfaceLine {
  std::string name;
  std::vector<std::optional<SurfaceMarker>> markers;
  // Distances from the first and the last marker that the layout lists to the edge of the cloth,
  // where it is known.
  std::optional<double> luff_offset_m{}, leech_offset_m{};
};

// An edge of the sail, measured or from the design.
struct SurfaceEdge {
  std::vector<Eigen::Vector3d> points_m;  // a polyline in the shape frame; empty if unknown
  double beyond_m = 0.0;                  // how far beyond these points the cloth ends, along it
  // Whether the points are those of markers through which the surface goes anyway: they say where
  // it ends, not where it is.
  bool is_seen = false;
};

// Luff and leech from foot to head, foot and head from luff to leech.
struct SurfaceEdges {
  SurfaceEdge luff, leech, foot, head;
};

struct SurfaceInput {
  std::vector<SurfaceLine> lines;      // from foot to head
  std::vector<SurfaceMarker> markers;  // markers of the part on no horizontal line
  // Distances from the lowest and the highest line that the layout lists to the edge of the cloth.
  std::optional<double> foot_offset_m{}, head_offset_m{};
  SurfaceEdges edges{};  // by lines of markers or points of markers along them
  // Why the line or the points of the layout give no edge; empty if they give one, or if there are
  // none.
  std::string luff_note{}, leech_note{}, foot_note{}, head_note{};
};

// Collects the horizontal lines of `part` from foot to head, its other markers, and the places of
// its edges from the layout. Uses whole markers only. A marker on no horizontal line whose centre
// is a point of an edge belongs to the edge, unless the cloth goes on beyond it. Lines that the
// layout lists from head to foot are turned round: they run against `up_in_shape`, a unit vector,
// or without one against the vertical lines. The sigma of a marker is the root mean square of the
// three sigmas of its centre, with the errors that it shares with others: neighbours share some
// that bend the surface, which the noise of single markers does not show. The sigma of its tilt
// follows from the part of the corners' variances that exceeds the variance of the centre.
SurfaceInput CollectSurfaceInput(const MarkerShape& shape, const LayoutPart& part,
                                 const std::optional<Eigen::Vector3d>& up_in_shape = std::nullopt);

}  // namespace velamap
