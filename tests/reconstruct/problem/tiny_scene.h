// A small scene whose problem of adjustment is solved densely, and weights without a loss.

#pragma once

#include <limits>

#include "reconstruct/problem/marker_problem.h"
#include "tests/support/synthetic_scene.h"

namespace velamap {

inline MarkerWeights WeightsWithoutLoss() {
  MarkerWeights weights;
  weights.loss_sigmas = std::numeric_limits<double>::infinity();
  weights.print_tolerance = 1e-3;
  return weights;
}

inline SyntheticScene TinyScene() {
  SyntheticSceneOptions options;
  options.num_rows = 2;
  options.num_columns = 3;
  options.num_frames = 6;
  return MakeSyntheticScene(options);
}

}  // namespace velamap
