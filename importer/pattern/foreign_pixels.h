// Pixels that show something in front of a marker: a rope or its shadow, a seam, a glint, dirt.

#pragma once

#include "importer/pattern/pattern_problem.h"

namespace velamap {

// Fits again without such pixels. The model misses the middle of what they show by far more than
// the noise and by a part of the contrast, and the blur mixes it into the pixels around. Leaves the
// fit as it is where there are hardly any, or too many to be foreign. False for a singular system
// or a refit that has lost the marker.
bool RefitWithoutForeignPixels(PatternProblem* problem, PatternMinimum* minimum);

}  // namespace velamap
