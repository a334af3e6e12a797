// Mean marker points over registered frames (thesis section 3.5).

#pragma once

#include <vector>

#include "reconstruct/geometry/frame_shape.h"

namespace velamap {

struct ShapeAveragingOptions {
  int num_iterations = 30;  // of the weighted mean
  // Width of the weights exp(-distance / sigma). The thesis gives 0.6 without a unit; metres here.
  double sigma_m = 0.6;
};

// One marker in one registered frame: its pose solutions moved into the shape frame, m.
using MarkerSolutions = std::vector<MarkerPoints>;

// The iterated weighted mean of one marker's points: starts at the plain mean, then weighs every
// point by exp(-|point - mean| / sigma). Each frame takes part with one of its pose solutions: the
// one nearer to the medoid, the solution that all frames together agree with best. The order of
// frames does not matter beyond rounding. `frames` must not be empty.
MarkerPoints AverageMarker(const std::vector<MarkerSolutions>& frames,
                           const ShapeAveragingOptions& options);

}  // namespace velamap
