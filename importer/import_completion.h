// What can only be done when all frames are in the database.

#pragma once

#include "importer/database/colmap_database.h"
#include "importer/track/frame_detector.h"

namespace velamap {

// Numbers the corners of symmetric markers that the frames alone could not (rotation_evidence.h),
// in images of this and of earlier runs, and writes those images anew in one transaction. Returns
// how many detections were resolved; less than zero when new frames contradict what was resolved
// before.
int ResolveDoubtfulRotations(const FrameDetector& detector, ColmapDatabase* database);

// Matches every pair that is worth it and has none yet; returns the number of pairs with matches.
int WriteAllMatches(ColmapDatabase* database);

}  // namespace velamap
