// What camera and print do to the edges of a source of frames: the first step of an import.

#pragma once

#include <string>

#include "importer/refine/formation_estimation.h"
#include "importer/track/frame_detector.h"
#include "importer/video/video_options.h"

namespace velamap {

// Estimates the image formation from markers of up to 16 frames: of photographs spread over the
// folder, of a video every fifth frame from its beginning, which may be read for this a second
// time. The parameters are the defaults where fewer than four markers can be fitted.
FormationEstimate EstimateFormationOfSource(const std::string& image_path,
                                            const VideoOptions& video, int num_threads,
                                            const FrameDetector& detector);

}  // namespace velamap
