// Where the edges inside of markers lie, compared with the fitted models.
//
// The tone curve and the spread of ink move edges between dark and light cells to one side, towards
// dark or towards light. The corners of a marker follow its outer edges, which all have the same
// polarity; inner edges have both, so that they show what is left of such a shift, whatever its
// cause and whatever the shape of a blurred edge.

#pragma once

#include "importer/formation/formation_state.h"

namespace velamap {

// Means over all samples, in sigmas of the blur. Positive: dark cells are larger than in the model.
struct EdgeShift {
  double mean_blurs = 0.0;
  double sigma_blurs = 0.0;  // of the mean, from the scatter of the samples
  // Half of the difference between the edges that the rows and that the columns of the images
  // cross: many cameras treat the two directions differently, which no parameter describes.
  double half_difference_blurs = 0.0;
};

EdgeShift InnerEdgeShift(const FormationState& state);

}  // namespace velamap
