// Decides which of two markers that claim the same place is really there.

#pragma once

#include "importer/layout/layout.h"
#include "reconstruct/evidence/judged_line.h"

namespace velamap {

// Drops misread ids until no two markers claim the same place. The lines of the layout decide
// first, then the numbers of images that show each marker. See FindContradictions().
void DecideBetweenRivals(const Layout& layout, Evidence* evidence);

}  // namespace velamap
