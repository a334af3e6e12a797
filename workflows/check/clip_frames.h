// A few frames of a clip with their pixels, spread over all of it.

#pragma once

#include <string>
#include <vector>

#include "importer/video/frame_source.h"

namespace velamap {

struct ClipFrames {
  std::vector<Frame> frames;  // loaded, in order
  int num_frames = 0;         // that `video` chooses; 0 if the container does not say
  int num_unreadable = 0;
  bool is_video = false;
};

// The part of a video that holds about `max_num_frames` frames at equal distances.
VideoOptions SpreadOverClip(const std::string& image_path, const VideoOptions& video,
                            int max_num_frames);

// Up to `max_num_frames` frames, of a video some of those that `video` chooses. Throws InputError
// where OpenFrameSource() does and if no frame can be read.
ClipFrames ReadClipFrames(const std::string& image_path, const VideoOptions& video,
                          int max_num_frames, int num_threads);

}  // namespace velamap
