#include "exporters/formats/surface_spline.h"

#include <gtest/gtest.h>

#include "tests/exporters/sail/example_surface.h"

namespace velamap {
namespace {

// Flat, 2 m by 3 m, in the plane y = 0; x is u, z is v.
SplineSurface FlatRectangle() {
  const auto rectangle = [](double u, double v) { return Eigen::Vector3d(2 * u, 0, 3 * v); };
  return FitSurface(AsExact(MarkersOn(rectangle, 4, 5))).surface;
}

SplineSurface SplineSail() { return FitSurface(MarkersOn(TwistedSail, 8, 9)).surface; }

TEST(SurfaceSpline, BasisFunctionsSumToOne) {
  const SplineSurface surface = SplineSail();
  for (const double t : {0.0, 0.1, 0.37, 0.5, 0.99, 1.0}) {
    const Eigen::MatrixXd row = BasisRow(surface.knots_u, 3, t, 3);
    EXPECT_NEAR(row.row(0).sum(), 1, 1e-14);
    for (int order = 1; order <= 3; ++order) EXPECT_NEAR(row.row(order).sum(), 0, 1e-7);
  }
}

TEST(SurfaceSpline, DerivativesAreThoseOfThePoints) {
  constexpr double kStep = 1e-5;
  const SplineSurface surface = SplineSail();
  for (const double u : {0.2, 0.55, 0.9}) {
    for (const double v : {0.1, 0.48, 0.8}) {
      const SurfaceJet jet = EvaluateJet(surface, u, v);
      const SurfaceJet right = EvaluateJet(surface, u + kStep, v);
      const SurfaceJet left = EvaluateJet(surface, u - kStep, v);
      const SurfaceJet above = EvaluateJet(surface, u, v + kStep);
      const SurfaceJet below = EvaluateJet(surface, u, v - kStep);
      EXPECT_LT((jet.x - EvaluatePoint(surface, u, v)).norm(), 1e-14);
      EXPECT_LT((jet.x_u - (right.x - left.x) / (2 * kStep)).norm(), 1e-7);
      EXPECT_LT((jet.x_v - (above.x - below.x) / (2 * kStep)).norm(), 1e-7);
      EXPECT_LT((jet.x_uu - (right.x_u - left.x_u) / (2 * kStep)).norm(), 1e-3);
      EXPECT_LT((jet.x_uv - (above.x_u - below.x_u) / (2 * kStep)).norm(), 1e-3);
      EXPECT_LT((jet.x_vv - (above.x_v - below.x_v) / (2 * kStep)).norm(), 1e-3);
      EXPECT_NEAR(jet.normal.norm(), 1, 1e-14);
    }
  }
}

TEST(SurfaceSpline, AreaOfARectangleIsWidthTimesHeight) {
  EXPECT_NEAR(SurfaceArea(FlatRectangle()), 6, 1e-10);
}

TEST(SurfaceSpline, FootOfAPerpendicularHasSignAndSide) {
  const SplineSurface surface = FlatRectangle();
  // S_u x S_v = x cross z = -y.
  const auto feet = ProjectOnSurface(
      surface, {{0.7, -0.2, 1.1}, {0.7, 0.3, 1.1}, {2.5, -0.1, 1.0}, {-0.3, 0, 3.4}});
  EXPECT_NEAR(feet[0].distance_m, 0.2, 1e-12);
  EXPECT_NEAR(feet[0].u, 0.35, 1e-10);
  EXPECT_NEAR(feet[0].v, 1.1 / 3, 1e-10);
  EXPECT_EQ(feet[0].beyond_edge_m, 0);
  EXPECT_NEAR(feet[1].distance_m, -0.3, 1e-12);
  EXPECT_NEAR(feet[2].distance_m, 0.1, 1e-12);
  EXPECT_NEAR(feet[2].beyond_edge_m, 0.5, 1e-10);
  EXPECT_NEAR(feet[3].beyond_edge_m, 0.5, 1e-10);  // 3, 4, 5 beside a corner
  EXPECT_EQ(feet[3].u, 0);
  EXPECT_EQ(feet[3].v, 1);
}

TEST(SurfaceSpline, FootOnACurvedSurfaceIsPerpendicular) {
  const SplineSurface surface = SplineSail();
  for (const double u : {0.15, 0.5, 0.83}) {
    for (const double v : {0.2, 0.7}) {
      const SurfaceJet jet = EvaluateJet(surface, u, v);
      const auto feet = ProjectOnSurface(surface, {jet.x + 0.05 * jet.normal});
      EXPECT_NEAR(feet[0].distance_m, 0.05, 1e-9);
      EXPECT_NEAR(feet[0].u, u, 1e-7);
      EXPECT_NEAR(feet[0].v, v, 1e-7);
    }
  }
}

}  // namespace
}  // namespace velamap
