// Residuals of the corners in sigmas. They calibrate the corner noise and tell which corners are
// outliers.

#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/problem/marker_problem.h"

namespace velamap {

struct CornerResidual {
  Point3DId point3D_id = 0;
  TrackElement element;
  Eigen::Vector2d error_px = Eigen::Vector2d::Zero();  // of the corner from its place
  double sigmas = 0.0;                                 // its length, in calibrated sigmas
};

std::vector<CornerResidual> EvaluateCorners(const MarkerProblem& problem);

struct VarianceFactor {
  double value = 0.0;
  double redundancy = 0.0;  // number of residuals minus number of parameters
};

// Variance factor of the corners by their median residual, which outliers do not move. Counts 6
// parameters for each image but the first and 3 for each point.
VarianceFactor RobustVarianceFactor(const std::vector<CornerResidual>& corners, const Model& model);

// Takes the corners beyond `max_sigmas` out of the model and appends them to `removed`.
void RemoveOutliers(const std::vector<CornerResidual>& corners, double max_sigmas, Model* model,
                    std::vector<RemovedObservation>* removed);

// Mean length of a marker's sides in the images, px, by marker id. Markers are left out if no image
// sees two neighbouring corners of them.
std::map<int, double> MeanSidesPx(const Model& model);

// Median length of all sides in the images, px. Infinite if no image sees two neighbouring
// corners.
double MedianSidePx(const Model& model);

}  // namespace velamap
