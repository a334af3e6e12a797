#include <gtest/gtest.h>

#include "reconstruct/geometry/marker_pose.h"
#include "reconstruct/map/map_refinement.h"
#include "tests/support/gradient_check.h"

namespace velamap {
namespace {

Rigid3 FramePose(double turn) {
  return {
      Eigen::Quaterniond(Eigen::AngleAxisd(3.0 + turn, Eigen::Vector3d(1, 0.2, 0).normalized())),
      {0.1, -0.2 + turn, 2.5}};
}

// Two frames that see a marker near the place {}, with residuals of some sigmas.
struct TwoFrames {
  MapProblem problem;
  MapSolution solution;
  Sim3 place{1.01, Eigen::Quaterniond(0.9, 0.1, -0.2, 0.05).normalized(), {0.02, 0.03, 0.01}};

  TwoFrames() {
    problem.markers.push_back({7, CornersInMarker(0.1), {0, 1}});
    for (int frame_idx = 0; frame_idx < 2; ++frame_idx) {
      solution.cam_from_shape.push_back(FramePose(0.2 * frame_idx));
      MapObservation observation;
      observation.frame_idx = frame_idx;
      observation.sigma_px = 0.3;
      for (std::size_t i = 0; i < kNumCorners; ++i) {
        const Eigen::Vector3d x =
            FramePose(0.2 * frame_idx) * problem.markers[0].corners_in_marker[i];
        observation.rays[i] = x.hnormalized() + Eigen::Vector2d(1e-3, -2e-3);
        observation.px_from_ray[i] << 1000, 20, -10, 990;
      }
      problem.observations.push_back(observation);
    }
  }
};

TEST(RefineFramePose, DerivativesAreThoseOfTheCost) {
  const TwoFrames scene;
  const std::vector<PlacedObservation> placed = {{&scene.problem.observations[0], &scene.place},
                                                 {&scene.problem.observations[1], &scene.place}};
  ExpectGradientOfCost(FramePoseProblem(scene.problem, placed), FramePose(0.05), 1e-5);
}

TEST(RefineMarkerPlace, DerivativesAreThoseOfTheCost) {
  const TwoFrames scene;
  const std::vector<int> idxs = {0, 1};
  ExpectGradientOfCost(MarkerPlaceProblem(scene.problem, scene.solution, idxs), scene.place, 1e-5);
}

}  // namespace
}  // namespace velamap
