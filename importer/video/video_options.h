// Selects the frames of a video.

#pragma once

#include "importer/base/option.h"

namespace velamap {

struct VideoOptions {
  int first_frame = 0;  // zero-based
  int last_frame = -1;  // inclusive; -1: to the end
  int frame_step = 1;   // reads every k-th frame from the first

  void Check() const;  // throws InputError that names the option

  bool Selects(int frame_number) const;
};

bool operator==(const VideoOptions& a, const VideoOptions& b);

OptionGroup DescribeOptions(VideoOptions* options);

}  // namespace velamap
