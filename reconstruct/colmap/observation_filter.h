// Selects the observations for a bundle adjustment that has no robust loss.

#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Removes observations of points behind the camera, and those whose error is far beyond the usual
// error of the model, of their image and of their point; an image or a point that is misplaced as a
// whole keeps its observations. To be called before the first adjustment. Appends to `removed`.
void RemoveSeedOutliers(const BundleAdjustmentOptions& options, Model* model,
                        std::vector<RemovedObservation>* removed);

// Removes the outliers of an adjusted model and restores the observations of `removed` that have
// come to fit. Returns the number of observations that were removed or restored.
int ReviseObservations(const BundleAdjustmentOptions& options, Model* model,
                       std::vector<RemovedObservation>* removed);

// Removes all observations of corners that at most two images see and whose marker has lost a
// corner. Two images cannot show that one of them is wrong, but outliers among the other corners of
// the marker make it likely. All points of the model are corners. Appends to `removed`; returns
// whether any observations were removed.
bool RemoveUnprovenCorners(Model* model, std::vector<RemovedObservation>* removed);

// Returns the observation to the model, if its image and its point are still there, the point lies
// in front of the camera, and the reprojection error is at most `max_error_px`; else returns false.
bool RestoreObservation(const RemovedObservation& observation, double max_error_px, Model* model);

// Removes points with short tracks and images with fewer than four observations until there are
// none. Three observations determine a pose but cannot check it; fewer make the normal equations
// singular.
void RemoveUnderconstrained(int min_track_length, Model* model,
                            std::vector<ImageId>* removed_images);

// Throws DataError if fewer than two images or no points are left of the model. `num_images_before`
// and `num_outliers` are what it had and what was removed.
void CheckEnough(const Model& model, std::size_t num_images_before, std::size_t num_outliers);

}  // namespace velamap
