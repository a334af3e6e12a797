// The parts of a video: which of them would suffice for a reconstruction of their own, and what the
// others lack.

#pragma once

#include <vector>

#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "workflows/check/clip_facts.h"

namespace velamap {

// The frames of a video that were looked at, at equal distances.
struct FrameTimes {
  int first_frame = 0, frame_step = 1, num_frames = 0;
  double first_s = 0.0, seconds_per_frame = 0.0;
};

// A frame is poor if it has fewer than four markers, contradicts the other frames, or is blurred:
// if the corners of its markers are twice as uncertain as those of the same markers in the sharpest
// quarter of the frames.
//
// A part runs from frame to frame as long as four markers or more are in both; one or two poor
// frames between them do not end it. It is good if the camera moves around the object far enough to
// determine depth, which only `precision` (may be null) knows, and if two of its frames or more
// show three quarters of the markers, of each part of the layout, that the clip shows at all. The
// frames between these parts are poor parts. Returns all parts in the order of time.
std::vector<ClipPart> FindClipParts(const std::vector<DatabaseImage>& images,
                                    const FrameTimes& times, const Layout& layout,
                                    const ClipPrecision* precision);

}  // namespace velamap
