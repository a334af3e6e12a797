#include "tests/support/clip/cloth.h"

#include <cmath>

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(WalkOnSurfaceTest, GoesStraightOnAPlane) {
  const Surface skewed = [](const Eigen::Vector2d& uv) {
    return Eigen::Vector3d(2 * uv.x() + 0.5 * uv.y(), 0, 3 * uv.y());
  };
  const Eigen::Vector2d start(0.4, 0.3);
  const Eigen::Vector3d moved = skewed(WalkOnSurface(skewed, start, {0.03, 0.04})) - skewed(start);
  EXPECT_LT((moved - Eigen::Vector3d(0.03, 0, 0.04)).norm(), 1e-9);
}

TEST(WalkOnSurfaceTest, GoesAroundACylinderWithoutStretching) {
  const double radius_m = 0.5;
  const Surface cylinder = [=](const Eigen::Vector2d& uv) {
    return Eigen::Vector3d(radius_m * std::sin(uv.x()), -radius_m * std::cos(uv.x()), uv.y());
  };
  const Eigen::Vector2d end = WalkOnSurface(cylinder, {0.2, 0.5}, {0.06, 0.08});
  EXPECT_NEAR(end.x(), 0.2 + 0.06 / radius_m, 1e-6);
  EXPECT_NEAR(end.y(), 0.58, 1e-6);
}

TEST(WalkOnSurfaceTest, FollowsAGreatCircle) {
  const double radius_m = 2.0;
  const Surface globe = [=](const Eigen::Vector2d& uv) -> Eigen::Vector3d {
    return radius_m * Eigen::Vector3d(std::cos(uv.y()) * std::sin(uv.x()),
                                      -std::cos(uv.y()) * std::cos(uv.x()), std::sin(uv.y()));
  };
  const Eigen::Vector2d start(0.3, 0.4);
  const Eigen::Vector3d a = globe(start), b = globe(WalkOnSurface(globe, start, {0.1, -0.2}));
  const double angle = std::acos(a.dot(b) / (radius_m * radius_m));
  // Micrometres, on a way three times as long as from a marker's centre to its corner.
  EXPECT_NEAR(radius_m * angle, std::hypot(0.1, 0.2), 3e-6);
}

TEST(SailTest, HasTheStatedCamberDraftAndTwist) {
  const Mainsail shape;
  const Surface sail = MakeSail(shape);
  for (const double v : {0.1, 0.5, 0.8}) {
    const Eigen::Vector3d luff = sail({0, v}), chord = sail({1, v}) - luff;
    EXPECT_NEAR(chord.norm(), SailChord(shape, v), 1e-12);
    EXPECT_NEAR(std::atan2(-chord.y(), chord.x()), shape.twist_rad * v, 1e-12);
    double deepest = 0, draft = 0;
    for (double u = 0; u <= 1; u += 0.001) {
      const Eigen::Vector3d x = sail({u, v}) - luff;
      const double depth = (x - x.dot(chord) / chord.squaredNorm() * chord).norm() / chord.norm();
      if (depth > deepest) {
        deepest = depth;
        draft = u;
      }
    }
    EXPECT_NEAR(deepest, 0.10 + 0.02 * v, 1e-6);
    EXPECT_NEAR(draft, 0.4, 0.002);
  }
}

}  // namespace
}  // namespace velamap
