// Decides which of two markers that claim one place is really there. Private to this folder.

#pragma once

#include "importer/layout/layout.h"
#include "reconstruct/evidence/judged_line.h"

namespace velamap {

// Drops misread ids until no two markers claim one place: first where the lines decide, then by the
// numbers of images. See FindContradictions().
void DecideBetweenRivals(const Layout& layout, Evidence* evidence);

}  // namespace velamap
