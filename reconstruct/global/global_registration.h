// Global registration: a map of all markers grown from several starts, without a central frame.
//
// In the map, a marker is a square of its nominal side times a scale of its own, which a prior of
// 2 % holds near 1. This keeps a map of few views well-posed; the bundle adjustment finds the bend
// of the cloth later.
//
// 1. Frames. All photographs take part. A video, without frames that repeat the one before, is
//    divided into twice max_num_frames stretches of equal length, and the frame with the most and
//    sharpest markers of each is registered. Finally, the max_num_frames frames that add most to
//    the information on all marker centres are kept.
// 2. Starts. A map starts from two frames with many common markers and a parallax near 20 degrees.
//    Both reliefs of the pair are adjusted, and the better one is kept.
// 3. Growth. The frames that see most of the map join it by resection (map_resection.h), from the
//    two planar solutions of single markers and from P3P. A frame with two good poses waits. Each
//    marker is placed by the consensus of all registered frames that see it (map_intersection.h);
//    it keeps two places until the views decide between them. After every round, all poses and
//    places are adjusted with a Cauchy loss (map_adjustment.h).
// 4. Choice. num_starts maps grow to 32 frames, and the one that explains most observations is
//    kept. If two maps agree within the noise of the corners, no more are grown. The reversed
//    relief of the winner is tried once more.
// 5. Cleanup. Misread ids, ids in two places, markers whose side differs by 25 % from the others',
//    frames whose corners scatter three times as much as those of the other frames, and
//    observations beyond five robust sigmas are left out (map_cleanup.h), and so are the markers
//    that the layout contradicts (evidence/layout_evidence.h).
// 6. Doubt. The poses of single markers show the noise of the corners independently of the shape.
//    If the errors of the map are four times that noise, the result carries a note
//    (map_verdict.h). Frames that are sharp and yet do not fit, and frames with many outliers, may
//    come from another camera (CameraDoubt() in registration/registration.h).
//
// The order and the ids of the images do not change the result; the random seed only draws the
// triples.

#pragma once

#include <map>
#include <vector>

#include "reconstruct/registration/registration.h"
#include "reconstruct/registration/registration_options.h"

namespace velamap {

// RegisterFrames() with RegistrationMethod::kGlobal. Throws DataError if fewer than two images
// contain markers or no two of them agree on a map, and InputError for options out of range, a time
// order without frame numbers, and a central frame that is unknown or cannot be registered. Adds a
// note to a result whose errors are larger than the noise of the corners explains.
Registration RegisterFramesGlobally(const std::vector<DatabaseImage>& images,
                                    const std::map<CameraId, Camera>& cameras, const Layout& layout,
                                    const RegistrationOptions& options);

}  // namespace velamap
