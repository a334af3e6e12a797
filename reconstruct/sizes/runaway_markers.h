// Markers whose place an adjustment without sizes has lost.

#pragma once

#include <vector>

#include "importer/layout/layout.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Places markers anew whose sides are less than half or more than twice as long as the layout says.
// Where the images that see a marker hardly differ, an adjustment that does not know its size may
// move it to any distance, and its corners apart; the sizes would then pull harder than all images.
// Each is put where the pose in one of its images explains the others best, if this leaves errors
// below a fifth of its sides there. A marker that is printed at a wrong size stays, because no
// such place explains images from different sides. `model` is metric up to a fraction of its scale.
// Returns the ids of the markers, ascending.
std::vector<int> PlaceRunawayMarkersAnew(const Layout& layout, Model* model);

}  // namespace velamap
