// Reprojection errors of a model.

#pragma once

#include <vector>

#include "importer/base/statistics.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct ObservationError {
  Point3DId point3D_id = 0;
  TrackElement element;
  Eigen::Vector2d residual_in_image_px;  // projection minus observation
  double error_px = 0.0;                 // its length; infinite for a point behind the camera
};

// A point of the model that an image sees.
struct SeenPoint {
  Eigen::Vector3d x_in_world;
  Eigen::Vector2d x_in_image_px;
};

// The observations of `image` whose points `model` has; the image may belong to another model.
std::vector<SeenPoint> SeenPointsOf(const Model& model, const ModelImage& image);

// Returns one entry for each observation, ordered by point, then by position in the track.
std::vector<ObservationError> ComputeReprojectionErrors(const Model& model);

Statistics SummarizeReprojectionErrors(const Model& model);

// Sets every point's mean_error_px. COLMAP before 3.13 does not update it.
void UpdatePointErrors(Model* model);

}  // namespace velamap
