// The parameters u and v of the markers on the lines, and the knots of the surface.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "exporters/surface/surface.h"

namespace velamap {

// A point and its place on the surface.
struct PlacedPoint {
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();
  double u = 0.0, v = 0.0;
};

struct SurfaceObservation {
  int marker_id = -1;  // -1: a point of a given edge
  std::string line;
  double u = 0.0, v = 0.0;          // mean of those of the points
  std::vector<PlacedPoint> points;  // the corners 1 to 4 of a marker, or one point
  bool is_seen = false;             // of a given edge whose markers the surface goes through

  Eigen::Vector3d Center() const;  // mean of the points, shape frame, m
};

// The observations of a line or of a given edge, which are neighbours in the list, and how far the
// surface continues before the first and after the last of them, m.
struct ObservedRow {
  std::size_t first_idx = 0, last_idx = 0;
  double before_m = 0.0, after_m = 0.0;
  bool is_edge = false;  // foot or head, where they are given
};

// Luff or leech. If it is given, some of its points are observations, neighbours in the list.
struct ObservedEdge {
  // Given, or offset from the lines. Otherwise the surface ends at the ends of all rows.
  bool is_known = false;
  std::size_t first_idx = 0, num_points = 0;
  double beyond_m = 0.0;  // how far the surface continues beyond these points
};

struct SurfaceParameters {
  std::vector<SurfaceObservation> observations;
  std::vector<ObservedRow> rows;  // from foot to head
  ObservedEdge luff, leech;
  // How far the surface continues below the first row and above the last one.
  double below_m = 0.0, above_m = 0.0;
  int degree_u = 3, degree_v = 3;
  Eigen::ArrayXd knots_u, knots_v;
  double mean_length_u_m = 0.0, length_v_m = 0.0;
  std::vector<std::string> notes;
};

// Needs at least two lines with at least three markers each. u comes from MakeSurfaceRows
// (surface_rows.h); v sums the mean distances between neighbouring rows. `shows_between`: markers
// between the lines, or tilts, show the surface there; it doubles the knots in v, so that the
// surface can follow them. Throws the same errors as FitSurface.
SurfaceParameters AssignParameters(const std::vector<SurfaceLine>& lines, bool shows_between,
                                   const SurfaceOptions& options);

// Adds the points of the given luff and leech, beside the ends of the rows. Otherwise the surface
// would meet these edges on the lines only.
void AddEdgePoints(const SurfaceEdges& edges, SurfaceParameters* parameters);

}  // namespace velamap
