// The steps of an import that need all frames in the database.

#pragma once

#include "importer/database/colmap_database.h"
#include "importer/track/frame_detector.h"

namespace velamap {

// Resolves the rotation of symmetric markers that single frames left open (rotation_evidence.h), in
// images of this and of earlier runs, and replaces those images in one transaction. Returns the
// change in the number of accepted detections; negative if new frames contradict earlier results.
// Warns of such markers that are accepted.
int ResolveDoubtfulRotations(const FrameDetector& detector, ColmapDatabase* database);

// Writes the matches of all pairs of PairsToMatch() that have none yet. Returns the number of
// pairs.
int WriteAllMatches(ColmapDatabase* database);

}  // namespace velamap
