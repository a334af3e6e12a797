// Samples of markers that bend, with a curved surface or by a lens that is not known. Their cubic
// terms, which a fit of a flat pattern lacks, would otherwise be taken for edges that camera and
// printer move.

#pragma once

#include <vector>

#include "importer/formation/fit_workers.h"
#include "importer/formation/fitted_sample.h"

namespace velamap {

// Whether more than a quarter of the samples bend by more than 2 % of a side and a quarter of a
// pixel. A bend hardly depends on the image formation that it is found with.
bool ShowBend(const std::vector<FormationSample>& samples, const ImageFormation& formation,
              const FitWorkers& workers);

// Takes a step towards the best corners and terms of PatternBend, for about `max_pixels` pixels of
// the fitted sample; then fits the other parameters again as RefinePatternFit() does. The bend
// changes little from one image formation to the next, so one step suffices. Returns false for a
// singular system.
bool FollowBend(int max_pixels, double tolerance_px, FittedSample* sample);

}  // namespace velamap
