// Where on a surface the markers of its lines lie: u and v of each, and the knots that go with
// them.

#pragma once

#include <string>
#include <vector>

#include "exporters/sail/surface.h"

namespace velamap {

struct SurfaceObservation {
  int marker_id = -1;  // -1: a point of a given edge
  std::string line;
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();
  double u = 0.0, v = 0.0;
};

struct SurfaceParameters {
  std::vector<SurfaceObservation> observations;
  std::vector<double> line_vs;  // of the lines, and of foot and head edges
  bool has_markers_between = false;
  int degree_u = 3, degree_v = 3;
  Eigen::ArrayXd knots_u, knots_v;
  double mean_length_u_m = 0.0, length_v_m = 0.0;
  std::vector<std::string> notes;
};

// `lines` have at least three markers each and are at least two. u is the chord length from the
// luff over that of the whole line; v adds up the mean distances between neighbouring lines. A
// missing marker at a line's end counts with the line's mean spacing, so that the surface's edge is
// not drawn in. `has_markers_between`: v gets twice as many knots, so that the surface can follow
// markers between the lines as well. Throws DataError as FitSurface does.
SurfaceParameters AssignParameters(const std::vector<SurfaceLine>& lines, bool has_markers_between,
                                   const SurfaceOptions& options);

}  // namespace velamap
