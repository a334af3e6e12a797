#include "reconstruct/problem/scale_bar.h"

#include <gtest/gtest.h>

#include "tests/reconstruct/problem/tiny_scene.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

// Central differences of the length.
TEST(BarGradient, IsTheDerivativeOfTheLength) {
  SyntheticScene scene = TinyScene();
  scene.layout.distances = {{0, 0, 5, 1, 0.6, 1e-3, true}};
  MarkerState state = MakeMarkerState(MakeSceneModel(scene), scene.layout);
  const ScaleBar bar = FindScaleBars(state, scene.layout.distances).at(0);
  const Eigen::VectorXd gradient = BarGradient(bar, state);
  const auto length = [&] {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (int slot = 0; slot < kNumCorners; ++slot) {
      center += CornerPosition(state.markers.at(0), slot) / kNumCorners;
    }
    return (CornerPosition(state.markers.at(5), 0) - center).norm();
  };
  constexpr double kStep = 1e-6;
  Eigen::Index column = 0;
  for (MarkerBlock& marker : state.markers) {
    for (double& x : marker.x_in_world) {
      const double before = x;
      x = before + kStep;
      const double above = length();
      x = before - kStep;
      const double below = length();
      x = before;
      EXPECT_NEAR(gradient[column++], (above - below) / (2 * kStep), 1e-8);
    }
  }
}

}  // namespace
}  // namespace velamap
