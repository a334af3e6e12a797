// Which observations take part in a bundle adjustment that has no robust loss of its own.

#pragma once

#include <vector>

#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Takes out what stands out before anything is adjusted: observations of points behind the camera,
// and those far beyond the common error of the model, of their image and of their point. A seed's
// image or point that is merely misplaced as a whole keeps its observations. Appends to `removed`.
void RemoveSeedOutliers(const BundleAdjustmentOptions& options, Model* model,
                        std::vector<RemovedObservation>* removed);

// Judges all observations of an adjusted model: takes outliers out and brings those of `removed`
// back that fit now. Returns how many changed sides.
int ReviseObservations(const BundleAdjustmentOptions& options, Model* model,
                       std::vector<RemovedObservation>* removed);

// Takes out all observations of corners that only two images see and whose marker is not whole. Two
// images place a corner somewhere whatever is wrong with one of them; that its marker's other
// corners were outliers says that something is. Appends to `removed`; returns whether it did.
bool RemoveUnprovenCorners(Model* model, std::vector<RemovedObservation>* removed);

// Removes points with too short a track and images with fewer than four observations, until none is
// left. Three fix a pose with nothing to check it; fewer make the normal equations singular.
void RemoveUnderconstrained(int min_track_length, Model* model,
                            std::vector<ImageId>* removed_images);

}  // namespace velamap
