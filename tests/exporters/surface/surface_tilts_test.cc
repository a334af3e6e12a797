// What the corners of markers tell a surface beyond their middles.

#include "exporters/surface/surface.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "tests/exporters/sail/example_surface.h"
#include "tests/support/error_matchers.h"

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

// Turns a marker about its vertical axis by 10 degrees, a hundred times the noise of its tilt.
TEST(Surface, APeelingMarkerHardlyMovesIt) {
  SurfaceInput input = CornersOn(TwistedSail, 7, 9, 0.015, 0.008);
  AddNoise(1e-4, true, 1, &input);
  const SplineSurface before = FitSurface(input).surface;
  SurfaceMarker& peeling = *input.lines[3].markers[4];
  const Eigen::AngleAxisd turn(10 * kRadPerDeg, Eigen::Vector3d::UnitZ());
  for (Eigen::Vector3d& corner : peeling.corners_in_shape_m) {
    corner = peeling.x_in_shape_m + turn * (corner - peeling.x_in_shape_m);
  }
  const SplineSurface after = FitSurface(input).surface;
  double largest_m = 0.0;
  for (double u = 0.05; u < 1; u += 0.1) {
    for (double v = 0.05; v < 1; v += 0.1) {
      const SurfaceFoot foot = ProjectOnSurface(before, {EvaluatePoint(after, u, v)}).front();
      largest_m = std::max(largest_m, std::abs(foot.distance_m));
    }
  }
  EXPECT_LT(largest_m, 1e-4);
}

// Noisy corners whose sigma is stated as zero, with markers between the lines, make a surface
// swing. Corners that followed it would find a way to hide that.
TEST(Surface, ExactMarkersWithNoisyCornersBearNone) {
  for (const double noise_m : {1e-5, 1e-3}) {
    SurfaceInput input = CornersOn(TwistedSail, 5, 12, 0.01, 0.01);
    for (SurfaceLine& line : CornersOn(TwistedSail, 25, 3, 0.01, 0.01).lines) {
      line.markers[1]->marker_id += 500;
      input.markers.push_back(*line.markers[1]);
    }
    AddNoise(noise_m, false, 1, &input);
    ExpectThrows<DataError>([&] { FitSurface(AsExact(input)); }, {"would oscillate"});
  }
}

}  // namespace
}  // namespace velamap
