// The places of the markers on the surface that is fitted to them, and its outline around them.

#pragma once

#include <vector>

#include "exporters/surface/surface_parameters.h"

namespace velamap {

// Places (u, v) of a surface at which the cloth ends: the ends of the rows and the given points of
// luff and leech, from foot to head; along the outer rows for foot and head, from luff to leech.
struct SurfaceOutline {
  std::vector<Eigen::Vector2d> luff, leech, foot, head;
};

// Continues the rows along the surface from the feet of their outer points. The feet may lie
// beyond u and v of 0 and 1.
SurfaceOutline OutlineOf(const SplineSurface& surface, SurfaceParameters parameters);

// Moves the markers, by their corners, and the points of given edges to their feet on the surface,
// also beyond its edge. Then rescales u and v of all of them so that they and the outline span 0 to
// 1 again. The chord length of a marker depends on where its line begins; its foot does not.
void MoveMarkersToFeet(const SplineSurface& surface, SurfaceParameters* parameters);

// For interpolating surfaces, whose markers on lines keep their chord lengths. The first function
// moves the corners of each marker around the marker's place; they must follow a smooth surface,
// because on one that oscillates they have no feet. The second moves the markers that are on no
// line of the fit to their feet, but not beyond the edge.
void MoveCornersAroundMarkers(const SplineSurface& surface, SurfaceParameters* parameters);
void MoveMarkersBetweenLinesToFeet(const SplineSurface& surface, SurfaceParameters* parameters);

}  // namespace velamap
