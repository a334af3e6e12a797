// Options of the sections, section.h.

#pragma once

#include <vector>

#include "importer/base/option.h"

namespace velamap {

struct SectionOptions {
  std::vector<double> heights_m;  // of sections besides the lines, z in the frame; finite
  int min_markers = 4;            // whole ones on a line

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(SectionOptions* options);

}  // namespace velamap
