// The precision that a plan of views gives: their observations are simulated, and velamap's
// marker-aware adjustment and covariance treat them like those of a clip.

#pragma once

#include <map>
#include <string>
#include <vector>

#include "importer/camera/camera.h"
#include "workflows/plan/plan_options.h"
#include "workflows/plan/plan_views.h"

namespace velamap {

struct PlanPrecision {
  std::map<int, double> marker_sigma_mm;  // in space, of the centres, with the scale
  double scale_sigma = 0.0;               // fraction
  // Expected rms distance of the corners from the truth after a rigid alignment, and after one with
  // scale: distance_sigma_mm and distance_after_scaling_sigma_mm of shape_analyzer.
  double distance_sigma_mm = 0.0, distance_after_scaling_sigma_mm = 0.0;
  std::vector<std::string> warnings;  // of the adjustment
};

// Draws by `options.seed` which markers are found and the errors of their corners. Throws DataError
// if the views give no shape.
PlanPrecision SimulatePlan(const PlannedSurface& surface, const Camera& camera,
                           const PlannedPath& path, const ShootPlanOptions& options);

}  // namespace velamap
