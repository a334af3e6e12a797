// Makes the coarse triangles of a surface through markers that are on no known lines: two triangles
// for each marker, and triangles that join the corners of neighbouring markers.
//
// An advancing front adds triangles in the order of their circumscribed circles, the smallest
// first. For an open edge, the third corner is the one of the Delaunay triangulation in the tangent
// plane: no other corner lies inside the circle through the three. (Bernardini et al., "The
// ball-pivoting algorithm", 1999; Cohen-Steiner and Da, "A greedy Delaunay-based surface
// reconstruction algorithm", 2004.) The normals keep opposite sides of a thin body apart. No
// triangle spans a gap that is far wider than the spacing of the markers, so a tube stays open at
// its ends.

#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "importer/base/ids.h"

namespace velamap {

// Corners 1..4 of a marker, clockwise as seen from outside, and the outward unit normals of the
// surface there.
struct FrontMarker {
  std::array<Eigen::Vector3d, kNumCorners> corners_in_shape_m;
  std::array<Eigen::Vector3d, kNumCorners> normals;
};

// Returns triangles of corner indices, counterclockwise as seen from outside. The index of a corner
// is kNumCorners * marker + corner - 1, where `marker` is an index into `markers`.
std::vector<std::array<int, 3>> JoinMarkers(const std::vector<FrontMarker>& markers);

// The number of edges that have a triangle on only one side.
int CountOpenEdges(const std::vector<std::array<int, 3>>& triangles);

// The connected component of each vertex, named by one of its vertices.
std::vector<int> PieceOfVertex(const std::vector<std::array<int, 3>>& triangles,
                               std::size_t num_vertices);

}  // namespace velamap
