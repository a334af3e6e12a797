// What a command reads and writes, by the uses of its options' paths.

#pragma once

#include <vector>

#include "importer/base/option.h"

namespace velamap {

// Once the options are set: sets outputs that are left out to the file beside another output, and
// throws InputError where CheckOutputs() (importer/base/replacement.h) does.
void CompletePaths(const std::vector<OptionGroup>& groups);

}  // namespace velamap
