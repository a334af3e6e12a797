// Draws where each marker goes: a picture with marker ids, line names and distances, and a table of
// the same to work from.

#pragma once

#include <optional>
#include <vector>

#include "importer/print/drawing.h"
#include "importer/print/placement.h"
#include "importer/print/sheet_plan.h"

namespace velamap {

// The markers to stick on and their places.
struct PlacementPlan {
  std::optional<Placement> placement;
  std::optional<LayoutPart> hull;  // a rigid part, on which the places are free
};

// The pages with the picture and then the table. They are not in true scale.
std::vector<Drawing> DrawPlacement(const PlacementPlan& plan, const Paper& paper);

}  // namespace velamap
