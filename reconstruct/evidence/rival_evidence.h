// Which of two markers that claim one place is there. Private to the evidence.

#pragma once

#include "importer/layout/layout.h"
#include "reconstruct/evidence/judged_line.h"

namespace velamap {

// Drops misread ids until no place has rivals: first those that the lines decide, then by numbers
// of images, see FindContradictions().
void DecideBetweenRivals(const Layout& layout, Evidence* evidence);

}  // namespace velamap
