// Pixels that show something in front of a marker: a rope or its shadow, a seam, a glint, dirt.

#pragma once

#include "importer/pattern/pattern_problem.h"

namespace velamap {

// Fits again without the pixels whose residuals exceed both 6 robust sigmas and a tenth of the
// contrast, and without the pixels around them that the blur affects. Leaves the fit as it is if
// there are hardly any such pixels, or too many to be foreign. Returns false if too few pixels lie
// on edges, for a singular system, or for a refit that has lost the marker.
bool RefitWithoutForeignPixels(PatternProblem* problem, PatternMinimum* minimum);

}  // namespace velamap
