// Where the edges inside markers lie, compared with the fitted models.
//
// The tone curve and the ink spread move edges between dark and light cells to one side, towards
// dark or towards light. The corners of a marker follow its outer edges, which all have the same
// polarity. Inner edges have both, so they reveal any remaining shift, independently of its cause
// and of the shape of a blurred edge. They also determine the size of the marker, which a shift
// common to all edges does not change.

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
  // How far outside the fitted corners the inner edges place the corners, along both sides, px.
  double corners_outwards_px = 0.0;
  double corners_sigma_px = 0.0;  // from the scatter of the samples, and from rounded corners
};

// Samples are weighted by the inverse square of their noise.
EdgeShift InnerEdgeShift(const FormationState& state);

}  // namespace velamap
