// Mean marker points over registered frames (thesis section 3.5).

#pragma once

#include <vector>

#include "reconstruct/geometry/frame_shape.h"
#include "reconstruct/registration/registration_options.h"

namespace velamap {

// One marker in one registered frame: its pose solutions moved into the shape frame, m.
using MarkerSolutions = std::vector<MarkerPoints>;

// Iterated weighted mean of one marker's points: starts with the plain mean and weights every point
// by exp(-|point - mean| / mean_sigma_m), num_mean_iterations times. The thesis gives 0.6 as the
// sigma, without a unit; metres here. Each frame contributes the pose solution that is nearest to
// the medoid: of the solutions of up to 16 frames, spread over all, the one with the smallest sum
// of distances to all frames. `frames` must not be empty.
MarkerPoints AverageMarker(const std::vector<MarkerSolutions>& frames,
                           const ThesisRegistrationOptions& options);

}  // namespace velamap
