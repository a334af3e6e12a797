// Which frames of a video are read.

#pragma once

#include "importer/base/option.h"

namespace velamap {

struct VideoOptions {
  int first_frame = 0;  // zero-based
  int last_frame = -1;  // -1: to the end
  int frame_step = 1;   // every k-th frame

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(VideoOptions* options);

}  // namespace velamap
