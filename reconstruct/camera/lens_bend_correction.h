// Corrects the corners of markers that were fitted before the lens was known.

#pragma once

#include <map>
#include <vector>

#include "importer/camera/camera.h"
#include "importer/database/colmap_database.h"

namespace velamap {

// Moves the corners from where an import without calibration found them to where a fit that knows
// how the lens bends the markers would have (importer/bend/pattern_bend.h). Through a fisheye of
// 100 degrees, markers of 80 px would otherwise come out 0.1 % too large. Corners that no edge fit
// has found, and images whose camera is missing, stay as they are.
void CorrectForLensBend(const std::map<CameraId, Camera>& cameras,
                        std::vector<DatabaseImage>* images);

}  // namespace velamap
