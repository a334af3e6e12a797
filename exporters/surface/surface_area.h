// Compares the area of a surface with the area that its markers suggest.

#pragma once

#include "exporters/surface/surface_ends.h"

namespace velamap {

// Throws DataError for a surface that oscillates between its markers, as one through scattered
// points does. `ends` says where the surface ends.
void CheckArea(const SortedInput& sorted, const SurfaceOptions& ends, const SplineSurface& surface);

}  // namespace velamap
