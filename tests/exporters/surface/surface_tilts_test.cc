// What the corners of markers tell a surface beyond their middles.

#include "exporters/surface/surface.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "importer/geometry/units.h"
#include "tests/exporters/sail/example_surface.h"

namespace velamap {
namespace {

// The corners of a marker lie on the cloth, and their mean within its bend.
TEST(Surface, LiesOnTheCloth) {
  constexpr double kSide_m = 0.3, kRadius_m = 4;
  const double du = kSide_m / 2 / (kRadius_m * 40 * kRadPerDeg), dv = kSide_m / 2 / 3;
  const SurfaceInput input = CornersOn(CylinderSail, 6, 8, du, dv);
  const double sag_m = kRadius_m - input.lines[0].markers[0]->x_in_shape_m.head<2>().norm();
  EXPECT_GT(sag_m, 0.0025);
  for (const bool is_exact : {false, true}) {
    const auto fitted = FitSurface(is_exact ? AsExact(input) : input);
    for (const double u : {0.1, 0.5, 0.9}) {
      const Eigen::Vector3d x = EvaluatePoint(fitted.surface, u, 0.4);
      EXPECT_NEAR(std::hypot(x.x(), x.y()), kRadius_m, 0.1 * sag_m) << is_exact;
    }
    EXPECT_LT(LargestResidual(fitted), 0.02 * sag_m) << is_exact;
  }
}

// Four lines do not show a bulge between two of them, but the markers on both are tilted by it.
TEST(Surface, TiltedMarkersShowTheShapeBetweenTheLines) {
  const auto bulging = [](double u, double v) -> Eigen::Vector3d {
    return TwistedSail(u, v) + Eigen::Vector3d(0, 0.02 * std::sin(3 * kPi * v), 0);
  };
  SurfaceInput input = CornersOn(bulging, 4, 10, 0.01, 0.01);
  std::mt19937 random(1);
  std::normal_distribution<double> noise_m(0.0, 2e-4);
  ForEachMarker(&input, [&](SurfaceMarker* marker) {
    marker->sigma_m = 2e-4;
    marker->tilt_sigma_m = 2e-5;  // too small, which the residuals show
    marker->x_in_shape_m.setZero();
    for (Eigen::Vector3d& corner : marker->corners_in_shape_m) {
      for (double& x : corner) x += noise_m(random);
      marker->x_in_shape_m += corner / 4;
    }
  });
  const double rms_m = TruthRms(FitSurface(input).surface, bulging);
  ForEachMarker(&input, [](SurfaceMarker* marker) { marker->corners_in_shape_m.clear(); });
  const double without_m = TruthRms(FitSurface(input).surface, bulging);
  EXPECT_GT(without_m, 0.008);
  EXPECT_LT(rms_m, 0.15 * without_m);
}

}  // namespace
}  // namespace velamap
