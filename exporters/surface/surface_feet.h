// The places of the markers on the surface that is fitted to them.

#pragma once

#include "exporters/surface/surface_parameters.h"

namespace velamap {

// The sides on which the surface goes on beyond the markers: it is extended there, or ends at given
// points of the edge.
struct OpenSides {
  Eigen::Array<bool, 2, 1> at_least, at_greatest;  // u, v
};
OpenSides OpenSidesOf(const SurfaceParameters& parameters, const SurfaceEdges& edges);

// Moves the markers to their feet on the surface, also beyond its edge. Then rescales u and v of
// all observations so that the markers span 0 to 1 again, except at open sides, where 0 or 1 is an
// edge beyond the markers and stays. The chord length of a marker depends on where its line begins;
// its foot does not.
void MoveToFeet(const SplineSurface& surface, const OpenSides& open, SurfaceParameters* parameters);

// Sets the sag of each marker with a known side: side^2 / 4 times the mean curvature of the surface
// there, which is how far the cloth at the middle of a marker lies from the mean of its corners.
void SetSags(const SplineSurface& surface, SurfaceParameters* parameters);

// Moves only the markers on no line of the fit, and none beyond the edge: for surfaces that
// interpolate, whose lines keep their chord lengths.
void MoveMarkersBetweenLinesToFeet(const SplineSurface& surface, SurfaceParameters* parameters);

}  // namespace velamap
