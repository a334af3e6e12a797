// Adjustment of a whole map: the poses of all frames and the places of all markers at once.
//
// Residuals of an observation are (projected - observed corner) / sigma_px, 8 numbers with a joint
// Cauchy loss. The residual of a marker is log(scale) / kScaleSigma, also with a Cauchy loss, so
// that the scale of the map is near the median of its markers. Markers are squares here, which
// keeps a map of few views well-posed; the bundle adjustment that follows finds the small bends of
// cloth.

#pragma once

#include <ceres/sized_cost_function.h>

#include "reconstruct/map/map_problem.h"

namespace velamap {

struct MapAdjustmentOptions {
  int max_num_iterations = 10;
  double tolerance = 1e-4;  // relative change of the cost at convergence
};

// Adjusts the registered frames and the placed markers that at least two of them see, on the
// inliers. A marker with two places takes part with the better one. The first registered frame is
// held.
void AdjustMap(const MapProblem& problem, const MapAdjustmentOptions& options,
               MapSolution* solution);

// Residuals and analytic derivatives of one observation. Parameters: the frame's rotation (x y z w)
// and translation; the marker's rotation, translation and log(scale).
class MapReprojectionCost : public ceres::SizedCostFunction<2 * kNumCorners, 7, 8> {
 public:
  MapReprojectionCost(const MapObservation& observation, const MapMarker& marker)
      : observation_(observation), marker_(marker) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const MapObservation& observation_;
  const MapMarker& marker_;
};

}  // namespace velamap
