// The parameters u and v of the markers on the lines, and the knots of the surface.

#pragma once

#include <string>
#include <vector>

#include "exporters/surface/surface.h"

namespace velamap {

struct SurfaceObservation {
  int marker_id = -1;  // -1: a point of a given edge
  std::string line;
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();
  double u = 0.0, v = 0.0;
  double side_m = 0.0;  // of the marker
  // From the mean of the corners to the cloth, which is bent between them.
  Eigen::Vector3d sag_m = Eigen::Vector3d::Zero();

  Eigen::Vector3d OnCloth() const { return x_in_shape_m + sag_m; }
};

struct SurfaceParameters {
  std::vector<SurfaceObservation> observations;
  int degree_u = 3, degree_v = 3;
  Eigen::ArrayXd knots_u, knots_v;
  double mean_length_u_m = 0.0, length_v_m = 0.0;
  std::vector<std::string> notes;
};

// Needs at least two lines with at least three markers each. u comes from MakeSurfaceRows
// (surface_rows.h); v sums the mean distances between neighbouring rows. `has_markers_between`
// doubles the knots in v, so that the surface can follow markers between the lines. Throws the same
// errors as FitSurface.
SurfaceParameters AssignParameters(const std::vector<SurfaceLine>& lines, bool has_markers_between,
                                   const SurfaceOptions& options);

}  // namespace velamap
