// A bundle adjustment of one clip that starts where that of a neighbouring central frame has ended.

#pragma once

#include "reconstruct/model/model.h"

namespace velamap {

// How much of a seed is a neighbour's.
struct WarmStart {
  int num_images = 0;  // whose poses are the neighbour's
  int num_points = 0;  // whose places are the neighbour's
};

// Moves `adjusted`, a model of the same database, onto `seed` by the points that both have, and
// takes over its points and the poses of its images. Observations, tracks and the order of images
// stay the seed's, and so does its world frame up to how well the two fit. Images that only
// the seed has are resected by least squares against its points. With fewer than half of the
// seed's points in common nothing is changed: {}.
WarmStart StartFromAdjusted(const Model& adjusted, Model* seed);

}  // namespace velamap
