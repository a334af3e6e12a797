// A marker in an image before its corners are refined, and one that is expected there.

#pragma once

#include <map>
#include <set>
#include <vector>

#include "importer/geometry/quad.h"

namespace velamap {

struct MarkerQuad {
  int marker_id = 0;
  QuadCorners corners_px;
  bool is_second_look = false;  // whether its code was read only in an enlarged picture
};

using QuadById = std::map<int, QuadCorners>;

// Returns the markers whose id was found exactly once.
inline QuadById SingleMarkers(const std::vector<MarkerQuad>& found) {
  QuadById quads;
  std::set<int> twice;
  for (const MarkerQuad& quad : found) {
    if (!quads.emplace(quad.marker_id, quad.corners_px).second) twice.insert(quad.marker_id);
  }
  for (const int id : twice) quads.erase(id);
  return quads;
}

// A marker that was not found, at a place where it should be visible.
struct ExpectedMarker {
  MarkerQuad quad;
  double reach_px = 0.0;  // how far it may be from its place
};

}  // namespace velamap
