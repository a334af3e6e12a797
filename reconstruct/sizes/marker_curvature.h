// The shortening of the sides of markers on curved surfaces: a side is printed along the surface,
// but the adjustment sees its chord, the straight distance between its corners.

#pragma once

#include <map>
#include <optional>

#include <Eigen/Core>

#include "importer/geometry/rigid3.h"
#include "reconstruct/problem/marker_state.h"

namespace velamap {

struct ChordSummary {
  double mean_shortening = 0.0;     // of all sides, as a fraction
  double largest_shortening = 0.0;  // of a marker's mean side
  int marker_id = 0;                // which has the largest
  // Of the markers whose sides are shortened, by id: the second derivatives of the height of the
  // surface above the marker, 1/m, in its frame (x right, y up, z out of the face).
  std::map<int, Eigen::Matrix2d> curvatures_1_m;
};

// The pose of a marker from its corners. Returns nothing unless it has four that span a plane.
std::optional<Rigid3> WorldFromMarker(const MarkerBlock& marker);

// Sets the chords of all markers. The ratio of chord to arc is 1 - (a kappa)^2 / 24, for an arc of
// the printed length a with the normal curvature kappa along the side. The curvature of a marker
// comes from a least-squares fit to the places and tilts of its neighbours: markers of the same
// part that are within four sides and tilted by less than 50 degrees relative to it. The variance
// of the curvature is subtracted from its square. Sides stay as printed if the product a kappa is
// below 0.1, if there are no neighbours, on parts that the layout calls rigid, whose faces may be
// flat, and if the neighbours contradict one smooth surface, as at the edge between two walls.
ChordSummary SetChords(MarkerState* state);

}  // namespace velamap
