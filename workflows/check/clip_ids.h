// The ids that a clip shows, beside those that the layout names.

#pragma once

#include <vector>

#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "workflows/check/clip_facts.h"

namespace velamap {

// Sets the ids of `facts` and their numbers of frames. Without images, no id was seen.
void CollectIds(const std::vector<DatabaseImage>& images, const Layout& layout, ClipFacts* facts);

}  // namespace velamap
