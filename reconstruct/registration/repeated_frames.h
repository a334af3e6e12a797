// Frames of a video that show the picture of the frame before once more. Cameras and editors repeat
// frames where one was dropped, or everywhere where they raise the frame rate.

#pragma once

#include <vector>

#include "importer/database/colmap_database.h"

namespace velamap {

// For each frame, whether it repeats the one before: the markers have moved by less than 3 % of the
// steps around it, or by less than a fifth of the distance that the noise of their corners causes
// between two pictures of one scene. `frames` are in the order of time. The result is false for a
// camera and an object that stand still, where all steps are noise, but true for a video that
// repeats a single picture.
std::vector<bool> FindRepeatedFrames(const std::vector<const DatabaseImage*>& frames);

}  // namespace velamap
