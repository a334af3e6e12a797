// Frames of a video that show the picture of the frame before once more. Cameras and editors repeat
// frames where one was dropped, or everywhere where they raise the frame rate.

#pragma once

#include <vector>

#include "importer/database/colmap_database.h"

namespace velamap {

// For each frame, whether it repeats the one before: whether the markers have moved less than 3 %
// as far as in the steps around it, or less than a fifth of what the noise of their corners moves
// those of two pictures. `frames` are in the order of time. The result is false for a camera and an
// object that stand still, where all steps are noise, but true for a video that stands still.
std::vector<bool> FindRepeatedFrames(const std::vector<const DatabaseImage*>& frames);

}  // namespace velamap
