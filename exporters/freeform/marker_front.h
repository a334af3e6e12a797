// The coarse triangles of a surface through markers that are on no known lines: two triangles per
// marker, facing along its normal, and triangles that join the markers from corner to corner.
//
// An advancing front adds the triangles from the smallest circle to the largest. The third corner
// of an open edge is the one of a Delaunay triangulation of the tangent plane there: no other one
// lies within their circle. (Bernardini et al., "The ball-pivoting algorithm", 1999; Cohen-Steiner
// and Da, "A greedy Delaunay-based surface reconstruction algorithm", 2004.) Normals keep opposite
// sides of a thin body apart. No triangle spans a gap that is far wider than the spacing of the
// markers, so a tube stays open at its ends.

#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "importer/base/ids.h"

namespace velamap {

// Corners 1..4 of a marker, clockwise seen from the outside, and the normals of the surface there.
struct FrontMarker {
  std::array<Eigen::Vector3d, kNumCorners> corners_in_shape_m;
  std::array<Eigen::Vector3d, kNumCorners> normals;
};

// Triangles of the corners, counter-clockwise seen from the outside: index kNumCorners * marker +
// corner - 1.
std::vector<std::array<int, 3>> JoinMarkers(const std::vector<FrontMarker>& markers);

// The edges that have a triangle on one side only.
int CountOpenEdges(const std::vector<std::array<int, 3>>& triangles);

// For each vertex, one vertex of the piece to which edges join it: the same one for all of a piece.
std::vector<int> PieceOfVertex(const std::vector<std::array<int, 3>>& triangles,
                               std::size_t num_vertices);

}  // namespace velamap
