#include "importer/video/video_options.h"

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {

void VideoOptions::Check() const {
  if (first_frame < 0) {
    throw InputError(
        fmt::format("--Video.first_frame: {} is negative; give 0 or more", first_frame));
  }
  if (last_frame < -1 || (last_frame >= 0 && last_frame < first_frame)) {
    throw InputError(fmt::format(
        "--Video.last_frame: {} is before the first frame {}; give -1 for the end of the video",
        last_frame, first_frame));
  }
  if (frame_step < 1) {
    throw InputError(
        fmt::format("--Video.frame_step: {} is too small; give 1 or more", frame_step));
  }
}

}  // namespace velamap
