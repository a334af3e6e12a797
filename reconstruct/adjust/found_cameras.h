// The cameras that an adjustment has found, with their sigmas.

#pragma once

#include <map>
#include <string>
#include <vector>

#include "importer/camera/calibration_writer.h"
#include "reconstruct/adjust/marker_solution.h"

namespace velamap {

// The cameras of the model with sigmas from the covariance, without those whose images were left
// out.
std::map<CameraId, EstimatedCamera> CamerasOf(const Model& model,
                                              const MarkerLinearization& linearization);

// Widens the sigmas of principal point and distortion to those for OPENCV, if the cameras have a
// model of fewer parameters. A tangential distortion that the model lacks is mistaken for a shift
// of the principal point, so the sigmas have to include its prior. The focal length keeps its
// sigma, because it hardly depends on either.
void WidenToOpenCV(const MarkerSolution& solution, std::map<CameraId, EstimatedCamera>* cameras);

// Throws DataError if the images do not determine a focal length (sigma above 5 %). `weakness` is
// the warning of FindWeakGeometry().
void CheckFocalLength(const std::map<CameraId, EstimatedCamera>& cameras,
                      const std::string& weakness);

// Adds the effect of an inset of all corners to the sigmas of the focal lengths: an inset changes
// the apparent foreshortening of the squares, and no picture shows it. `inset_as_scale` is 1 sigma
// of the relative change of a side that the inset causes (MarkerWeights::inset_as_scale).
void AddInset(double inset_as_scale, const Camera& camera, std::vector<double>* sigmas);

}  // namespace velamap
