// A marker in an image before its corners are refined, and one that is expected there.

#pragma once

#include "importer/geometry/quad.h"

namespace velamap {

struct MarkerQuad {
  int marker_id = 0;
  QuadCorners corners_px;
};

// A marker that was not found, at a place where it should be visible.
struct ExpectedMarker {
  MarkerQuad quad;
  double reach_px = 0.0;  // how far it may be from its place
};

}  // namespace velamap
