// Reprojection errors of a model: what every adjustment is judged by.

#pragma once

#include <vector>

#include "importer/base/statistics.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct ReprojectionError {
  Point3DId point3D_id = 0;
  TrackElement element;
  Eigen::Vector2d residual_in_image_px;  // projection minus observation
  double error_px = 0.0;                 // its length; infinite for a point behind the camera
};

// One entry an observation, ordered by point then track position.
std::vector<ReprojectionError> ComputeReprojectionErrors(const Model& model);

Statistics SummarizeReprojectionErrors(const std::vector<ReprojectionError>& errors);

// Sets every point's mean_error_px to the truth: COLMAP before 3.13 leaves stale ones.
void UpdatePointErrors(Model* model);

}  // namespace velamap
