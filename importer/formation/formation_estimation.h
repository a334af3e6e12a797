// Estimates how camera and print change edges: the image formation that explains the pixels of all
// samples best. Each sample has its own parameters (corners, blur, levels, margins); the image
// formation is common to all.

#pragma once

#include <cstddef>
#include <vector>

#include "importer/formation/fit_workers.h"
#include "importer/formation/fitted_sample.h"
#include "importer/pattern/formation_estimate.h"

namespace velamap {

constexpr std::size_t kMinFormationSamples = 2;

// Levenberg-Marquardt over gamma, S, sharpening, its radius, the ink's spread, the camera's shift
// of edges and the halo, with a Cauchy loss and priors around a usual camera and printer; the
// samples are fitted again after each step. Some of the samples are fitted from several starting
// gammas and amounts of sharpening; then all samples take a few steps. The shifts of edges and of
// outlines are then set from the places of inner edges (balanced_edges.h), and pixels at the
// corners of outlines are weighted by their residuals (OutlineCornerWeight()). If markers bend, the
// fits of the samples follow the bend (sample_bend.h). `is_inverted`: the samples hold 255 minus
// the recorded grey values. The number of threads does not change the result. If fewer than
// kMinFormationSamples can be fitted, the parameters are the defaults, with the inset that an
// unknown camera may cause.
FormationEstimate EstimateFormation(std::vector<FormationSample> samples, bool is_inverted,
                                    const FitWorkers& workers = {});

}  // namespace velamap
