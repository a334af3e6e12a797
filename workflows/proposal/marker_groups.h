// Groups of neighbouring markers of a clip: the lines of a sail, a face of a box, a rigid strip.

#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "reconstruct/evidence/marker_rows.h"
#include "workflows/proposal/clip_map.h"

namespace velamap {

struct MarkerGroup {
  RowGroup rows;
  std::size_t body_idx = 0;  // into ClipMap::bodies
};

// Most markers first.
std::vector<MarkerGroup> FindMarkerGroups(const ClipMap& map);

struct FacePlane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // in the frame of the body
  double rms_m = 0.0;                                // of the markers' corners
};

// The groups, by index, that are faces of a solid such as a box or two walls: flat, and tilted by
// at least 20 degrees relative to another flat group of the same body. A single flat group may be a
// sail on the floor, so it is no face.
std::map<std::size_t, FacePlane> FindFaces(const ClipMap& map,
                                           const std::vector<MarkerGroup>& groups);

}  // namespace velamap
