// A few frames of a clip with their pixels, spread over all of it.

#pragma once

#include <string>
#include <vector>

#include "importer/video/frame_source.h"

namespace velamap {

struct ClipFrames {
  std::vector<Frame> frames;  // loaded, in order
  int num_damaged = 0;        // left out, because a video is damaged there
  bool is_video = false;
};

// Chooses at most `max_num_frames` of the `num_frames` (0: unknown) that `video` chooses, at equal
// distances from the first to nearly the last.
VideoOptions SpreadOverClip(const VideoOptions& video, int num_frames, int max_num_frames);

// Reads up to `max_num_frames` frames: the first ones that `video` chooses, or photographs at equal
// distances. Throws InputError as OpenFrameSource() does and if no frame can be read.
ClipFrames ReadClipFrames(const std::string& image_path, const VideoOptions& video,
                          int max_num_frames, int num_threads);

}  // namespace velamap
