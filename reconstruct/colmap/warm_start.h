// Starts a bundle adjustment from the result around a neighbouring central frame of the same clip.

#pragma once

#include "reconstruct/model/model.h"

namespace velamap {

// The part of a seed that has been replaced.
struct WarmStart {
  int num_images = 0;  // images with adjusted poses
  int num_points = 0;  // points with adjusted positions
};

// Aligns `adjusted`, a model of the same database, with `seed` by the points that both have and
// copies its points and poses into `seed`. Observations, tracks, the order of images and, up to the
// accuracy of the alignment, the world frame of `seed` stay. Images that only the seed has are
// resected by least squares against its points. If the models share fewer than half of the seed's
// points, nothing changes and the result is {}.
WarmStart StartFromAdjusted(const Model& adjusted, Model* seed);

}  // namespace velamap
