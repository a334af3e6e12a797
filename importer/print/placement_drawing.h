// Draws where each marker goes: a picture with ids, names of lines and distances, and the same as a
// table to work from.

#pragma once

#include <vector>

#include "importer/print/drawing.h"
#include "importer/print/placement.h"
#include "importer/print/sheet_plan.h"

namespace velamap {

// The markers to stick on, and their places.
struct PlacementPlan {
  std::vector<Placement> placements;    // none or one
  std::vector<LayoutPart> rigid_parts;  // free places on something rigid, such as the hull
};

// Pages that are not in true scale: the picture first, the table behind it.
std::vector<Drawing> DrawPlacement(const PlacementPlan& plan, const Paper& paper);

}  // namespace velamap
