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

// Moves the points of an observation to their feet on the surface, also beyond its edge.
void MoveToFeet(const SplineSurface& surface, SurfaceObservation* observation);

// Moves the markers to their feet. Then rescales u and v of all observations so that the markers
// span 0 to 1 again, except at open sides, where 0 or 1 is an edge beyond the markers and stays.
// The chord length of a marker depends on where its line begins; its foot does not.
void MoveMarkersToFeet(const SplineSurface& surface, const OpenSides& open,
                       SurfaceParameters* parameters);

// Moves only the markers on no line of the fit, and none beyond the edge: for surfaces that
// interpolate, whose lines keep their chord lengths. The corners of a marker move around its place.
void MoveMarkersBetweenLinesToFeet(const SplineSurface& surface, SurfaceParameters* parameters);

}  // namespace velamap
