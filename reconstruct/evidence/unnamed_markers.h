// Finds markers that are on the object but not in the layout.

#pragma once

#include <vector>

#include "importer/database/colmap_database.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Returns, in ascending order, the ids that no part of the layout names and that are detected in at
// least two images and at least a quarter as often as the markers of the model. A blurred marker
// can be misread as another valid code, so detections in the place of a marker of the model do not
// count.
std::vector<int> FindUnnamedMarkers(const std::vector<DatabaseImage>& images, const Model& model);

}  // namespace velamap
