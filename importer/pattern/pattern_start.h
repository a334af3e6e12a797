// Where the fit of a whole marker's pixels starts: levels and widths that are read in the image.

#pragma once

#include "importer/pattern/pattern_problem.h"

namespace velamap {

constexpr double kMinMargin = 0.1, kMaxMargin = 1.5;  // cells

// Sets the initial parameters and the priors. Returns false for too little contrast.
bool StartPatternFit(const QuadCorners& corners_px, const ImageFormationParameters& formation,
                     PatternProblem* problem, PatternMinimum* minimum);

}  // namespace velamap
