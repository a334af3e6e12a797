// Finds shadows and other uneven light on a marker, which would move its edges: in grey values of a
// tone curve, cells in a shadow look smaller or larger than in the sun.

#pragma once

#include "importer/lighting/lighting.h"
#include "importer/pattern/pattern_problem.h"

namespace velamap {

// Fits again with an uneven lighting if the residuals of a fit have the pattern of one: the means
// over parts of the marker, relative to the light there, scatter much more than the noise within
// the parts explains, and up to two bands, or a curved fall-off, explain most of that scatter.
// Otherwise, for example if the ink of a print differs from cell to cell, the fit is kept, and the
// lighting is even.
Lighting FitLighting(PatternProblem* problem, PatternMinimum* minimum);

// What the uncertainty of the lighting adds to the inverse of the Hessian of the fit's parameters.
PatternParameters::Matrix AddedByLighting(const PatternProblem& problem,
                                          const PatternMinimum& minimum, const Lighting& lighting);

}  // namespace velamap
