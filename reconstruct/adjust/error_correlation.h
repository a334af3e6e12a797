// How much farther the result moves than independent errors of the corners would move it. Errors
// that neighbouring frames of a video have in common (the same pixel phases, the same blur), or the
// corners of one image (its pose, the lens), count as one error, not as many. Private to this room.

#pragma once

#include <vector>

#include "reconstruct/adjust/marker_problem.h"
#include "reconstruct/adjust/normal_equations.h"

namespace velamap {

// Up to five groups of images that follow one another by name, about equally many in each: by image
// of the state, 0, 1, ...
std::vector<int> GroupImages(const Model& model, const MarkerState& state);

// Factor of the corners' sigmas, 1 or more. What the residuals of each group move the shape by
// (after alignment with scale) is held against what independent errors of the same weights would
// move it by, which are drawn and taken through the same adjustment: so nothing is assumed of the
// groups' share in the parameters. 1 where the excess is within two sigmas of chance. Errors that
// are the same in all groups move nothing and are not seen. `problem` is that of `state` at its
// solution, without loss and calibrated.
double CorrelationFactor(const MarkerState& state, const MarkerProblem& problem,
                         const MarkerCovariance& covariance, const std::vector<int>& groups);

}  // namespace velamap
