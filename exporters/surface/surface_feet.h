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

// Moves the markers to their feet on the surface, also beyond its edge, and then u and v of all so
// that those of the markers go from 0 to 1 again, but for the open sides, which stay. Chord lengths
// differ between lines that begin at different distances from the luff; feet do not.
void MoveToFeet(const SplineSurface& surface, const OpenSides& open, SurfaceParameters* parameters);

// The sag of the markers of a surface that is bent like this: its mean curvature * side^2 / 4.
void SetSags(const SplineSurface& surface, SurfaceParameters* parameters);

// Moves the markers between the lines only, not beyond the edge.
void MoveMarkersBetweenLinesToFeet(const SplineSurface& surface, SurfaceParameters* parameters);

}  // namespace velamap
