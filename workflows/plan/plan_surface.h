// Where the markers of a plan are in space.
//
// Plan frame: the origin in the middle of the markers, x to the right and z up as a camera sees
// them from straight ahead, y away from it; m.

#pragma once

#include <string>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"
#include "importer/print/placement.h"

namespace velamap {

struct PlannedSurface {
  MarkerShape shape;  // plan frame, whole markers
  Layout layout;
  int num_cells = 6;                  // of a marker's side, border included
  bool is_of_shape = false;           // else of a placement
  std::vector<int> markers_left_out;  // of the layout: shape or placement do not have them
};

// A sail's placement bent by camber (depth / chord) and twist; a grid stays flat. Markers are flat
// squares that touch the surface. Rigid parts of `layout` go on a line below the foot.
PlannedSurface SurfaceOfPlacement(const Placement& placement, const Layout& layout, double camber,
                                  double twist_deg);

// The markers of a shape that the layout names, turned into the plan frame. Throws InputError,
// naming `path`, where there are none.
PlannedSurface SurfaceOfShape(const MarkerShape& shape, const Layout& layout,
                              const std::string& path);

}  // namespace velamap
