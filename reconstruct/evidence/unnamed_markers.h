// Finds markers that are on the object and that the layout does not name.

#pragma once

#include <vector>

#include "importer/database/colmap_database.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Ids that no part of the layout names and that the images show about as often as the markers of
// the model, in ascending order. A blurred marker can be misread as one with another legal code, so
// that detections where a marker of the model stands do not count.
std::vector<int> FindUnnamedMarkers(const std::vector<DatabaseImage>& images, const Model& model);

}  // namespace velamap
