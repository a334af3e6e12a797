#include "importer/video/video_options.h"

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {

OptionGroup DescribeOptions(VideoOptions* options) {
  return {"Video",
          {Common({"Video.first_frame", &options->first_frame, "frame",
                   "first frame to read, from 0", AtLeast(0)}),
           Common({"Video.last_frame", &options->last_frame, "frame",
                   "last frame to read; -1: the end", AtLeast(-1)}),
           Common({"Video.frame_step", &options->frame_step, "frames", "read every k-th frame",
                   AtLeast(1)})}};
}

void VideoOptions::Check() const {
  CheckRanges(*this);
  if (last_frame >= 0 && last_frame < first_frame) {
    throw InputError(fmt::format("{}: {} is before {} {}; give -1 for the end of the video",
                                 OptionName(&VideoOptions::last_frame), last_frame,
                                 OptionName(&VideoOptions::first_frame), first_frame));
  }
}

bool VideoOptions::Selects(int frame_number) const {
  return frame_number >= first_frame && (last_frame < 0 || frame_number <= last_frame) &&
         (frame_number - first_frame) % frame_step == 0;
}

bool operator==(const VideoOptions& a, const VideoOptions& b) {
  return a.first_frame == b.first_frame && a.last_frame == b.last_frame &&
         a.frame_step == b.frame_step;
}

}  // namespace velamap
