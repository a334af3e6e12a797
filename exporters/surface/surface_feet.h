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

// Moves the markers, by their corners, to their feet on the surface, also beyond its edge. Then
// rescales u and v of all observations so that the markers span 0 to 1 again, except at open sides,
// where 0 or 1 is an edge beyond the markers and stays. The chord length of a marker depends on
// where its line begins; its foot does not.
void MoveMarkersToFeet(const SplineSurface& surface, const OpenSides& open,
                       SurfaceParameters* parameters);

// For interpolating surfaces, where the markers on lines keep their chord lengths. The first
// function moves the corners of each marker around the marker's place; they must follow a smooth
// surface, because on one that oscillates they have no feet. The second moves the markers on no
// line of the fit to their feet, but none beyond the edge.
void MoveCornersAroundMarkers(const SplineSurface& surface, SurfaceParameters* parameters);
void MoveMarkersBetweenLinesToFeet(const SplineSurface& surface, SurfaceParameters* parameters);

}  // namespace velamap
