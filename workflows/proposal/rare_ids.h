// Ids that are read so rarely that they are probably misread: a blurred marker may give the code of
// another one, but hardly in frame after frame.

#pragma once

#include <map>
#include <set>
#include <vector>

#include "importer/database/colmap_database.h"

namespace velamap {

// The number of frames that show each id, rejected detections included.
std::map<int, int> CountFramesOfIds(const std::vector<DatabaseImage>& images);

// The ids that are read in fewer frames than a fifth of the median. Among a few photographs, none.
// Ids that only one frame shows do not count for the median: a dictionary of many short codes finds
// more of them in a busy picture than there are markers.
std::set<int> FindRareIds(const std::map<int, int>& num_frames_of_id);

}  // namespace velamap
