// How far the errors of the corners of one marker in one image agree.

#pragma once

#include "reconstruct/problem/marker_problem.h"
#include "reconstruct/problem/normal_equations.h"

namespace velamap {

// MarkerWeights::corner_correlation before the residuals show it. The fit of a marker's picture
// leaves its place less certain than its shape, because it also finds how far the marker bends, and
// codecs move markers as a whole: in 15 clips of another renderer, with the true corners known, the
// mean of the four corners had 1.6 to 3.0 times, mostly twice, the variance of independent corners,
// which is a correlation of 0.13 to 0.33.
constexpr double kUsualCornerCorrelation = 0.2;

// The correlation by the residuals of the markers that are seen with all four corners. Few
// residuals leave it close to the usual one. Cloth that flaps moves markers as a whole, too, but
// not independently from image to image, so the correlation is limited to 0.5. `problem` is at its
// solution and has no loss.
double EstimateCornerCorrelation(const MarkerProblem& problem, const MarkerJacobian& jacobian,
                                 const MarkerCovariance& covariance);

// Converts errors of the corners, px, into residuals and back. The first rows of `errors` are two
// for every entry of `corners`; other rows stay as they are.
void PixelsToResiduals(const MarkerProblem& problem, RowMajorMatrix* errors);
void ResidualsToPixels(const MarkerProblem& problem, RowMajorMatrix* errors);

}  // namespace velamap
