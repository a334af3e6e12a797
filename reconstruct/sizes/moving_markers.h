// Markers that move relative to the others, like those on a flapping leech.

#pragma once

#include <map>
#include <vector>

#include "reconstruct/model/model.h"
#include "reconstruct/problem/corner_residuals.h"
#include "reconstruct/problem/marker_problem.h"
#include "reconstruct/registration/corner_motions.h"

namespace velamap {

// By marker id, the factors by which the sigmas of the corners of a marker have to grow because it
// moves relative to the others: such a marker scatters around its mean place, and stays away from
// it for several images in a row. The square of a factor is the variance of the marker's mean
// residuals of each image, times the number of images that count as one independent image (the sum
// of the autocorrelations up to their first zero), relative to the median marker and to calibrated
// sigmas. The few images of a marker that hardly any image shows do not tell whether it moves; its
// neighbours in space do, so it gets the factor that their motion has over the same images. Holds
// only factors above 2. `problem` has no loss and was made with the factors `present`; the natural
// order of the images' names is that of time.
std::map<int, double> MotionFactors(const MarkerProblem& problem,
                                    const std::map<int, double>& present, const Model& model);

// Leaves out the corners of views with corners beyond `max_sigmas` that are there only because the
// surface moved (moved_views.h). `motions` tells which images are frames of a video.
std::vector<CornerResidual> WithoutMovedViews(const std::vector<CornerResidual>& corners,
                                              double max_sigmas, const Model& model,
                                              const CornerMotions& motions);

}  // namespace velamap
