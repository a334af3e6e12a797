// Estimates the image formation (how camera and print displace edges) from a source of frames: the
// first step of an import.

#pragma once

#include <functional>
#include <string>

#include "importer/base/progress_callback.h"
#include "importer/camera/camera.h"
#include "importer/formation/formation_estimation.h"
#include "importer/track/frame_detector.h"
#include "importer/video/frame_source.h"
#include "importer/video/video_options.h"

namespace velamap {

// Both are called from any thread.
struct FormationProgress {
  ProgressCallback frames;  // their number is unknown for a video
  ProgressCallback fits;    // of markers; their number is only estimated
};

// Estimates the image formation from about 32 markers: of up to 32 photographs of the folder, or of
// every fifth frame at the beginning of a video, and of later ones while too few markers are found.
// The video is read again for the import. The parameters are the defaults, with the inset that an
// unknown camera may cause, if fewer than two markers can be fitted. `camera_of` is called from any
// thread.
FormationEstimate EstimateFormationOfSource(const std::string& image_path,
                                            const VideoOptions& video, int num_threads,
                                            const FrameDetector& detector,
                                            const std::function<Camera(const Frame&)>& camera_of,
                                            const FormationProgress& progress = {});

}  // namespace velamap
