// Links between neighbouring markers on a surface, and chains of links that continue in one
// direction: the first two steps of marker_rows.h.

#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "reconstruct/geometry/frame_shape.h"

namespace velamap {

// A marker's centre and axes in the shape frame.
struct OrientedMarker {
  int marker_id = 0;
  Eigen::Vector3d center_m;
  Eigen::Vector3d right, up, normal;  // unit vectors; of the upright marker as a viewer sees it
};

std::vector<OrientedMarker> OrientedMarkers(const ShapePoints& shape);

// Indices of consecutive markers, at least one.
using MarkerChain = std::vector<std::size_t>;

bool ShareMarkers(const MarkerChain& a, const MarkerChain& b);

double Distance(const OrientedMarker& a, const OrientedMarker& b);

// The median distance between neighbours of the chain, which has at least two markers.
double SpacingOf(const std::vector<OrientedMarker>& markers, const MarkerChain& chain);

// Each chain has at least two markers. A marker may be on several chains, but a pair of neighbours
// is on only one.
std::vector<MarkerChain> FindChains(const std::vector<OrientedMarker>& markers);

}  // namespace velamap
