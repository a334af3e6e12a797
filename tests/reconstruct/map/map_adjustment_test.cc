#include "reconstruct/map/map_adjustment.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include "reconstruct/geometry/marker_pose.h"

namespace velamap {
namespace {

TEST(MapReprojectionCost, DerivativesAreThoseOfTheResiduals) {
  MapObservation observation;
  observation.sigma_px = 0.3;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    observation.rays[i] = {0.1 + 0.02 * static_cast<double>(i), -0.05};
    observation.px_from_ray[i] << 1000, 20, -10, 990;
  }
  MapMarker marker;
  marker.corners_in_marker = CornersInMarker(0.1);
  const MapReprojectionCost cost(observation, marker);
  Eigen::Matrix<double, 7, 1> frame;
  frame << Eigen::Quaterniond(0.8, 0.3, -0.4, 0.2).normalized().coeffs(), 0.2, -0.1, 2.0;
  Eigen::Matrix<double, 8, 1> place;
  place << Eigen::Quaterniond(0.5, -0.2, 0.6, 0.1).normalized().coeffs(), 0.3, 0.2, 0.5, 0.03;
  const ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>
      frame_manifold;
  const ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<4>>
      place_manifold;
  const std::vector<const ceres::Manifold*> manifolds = {&frame_manifold, &place_manifold};
  const ceres::GradientChecker checker(&cost, &manifolds, ceres::NumericDiffOptions{});
  const std::vector<const double*> parameters = {frame.data(), place.data()};
  ceres::GradientChecker::ProbeResults results;
  EXPECT_TRUE(checker.Probe(parameters.data(), 1e-6, &results)) << results.error_log;
}

}  // namespace
}  // namespace velamap
