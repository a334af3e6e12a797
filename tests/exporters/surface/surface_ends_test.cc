#include "exporters/surface/surface_ends.h"

#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/surface/surface.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "tests/exporters/sail/example_surface.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

TEST(SurfaceEnds, GoesOnBeyondItsMarkersAsItIsCurved) {
  SurfaceOptions options;
  options.luff_extension_mm = 300;
  options.leech_extension_mm = 200;
  options.foot_extension_mm = 250;
  options.head_extension_mm = 150;
  const auto fitted = FitSurface(AsExact(MarkersOn(CylinderSail, 6, 8)), options);
  const double arc_m = 4 * 40 * kRadPerDeg;
  EXPECT_NEAR(SurfaceArea(fitted.surface), (arc_m + 0.5) * 3.4, 0.01);
  EXPECT_NEAR(EvaluatePoint(fitted.surface, 0.5, 0).z(), -0.25, 1e-3);
  EXPECT_NEAR(EvaluatePoint(fitted.surface, 0.5, 1).z(), 3.15, 1e-3);
  for (const double u : {0.0, 0.05, 0.95, 1.0}) {
    const Eigen::Vector3d x = EvaluatePoint(fitted.surface, u, 0.4);
    EXPECT_NEAR(std::hypot(x.x(), x.y()), 4, 5e-4) << u;
  }
  EXPECT_LT(LargestResidual(fitted), 1e-10);
}

TEST(SurfaceEnds, ExtensionsAreLimitedToTheSizeOfThePart) {
  // 18 mm wide at the foot and 36 mm high.
  const SurfaceInput input = MarkersOn(
      [](double u, double v) -> Eigen::Vector3d { return 0.006 * TwistedSail(u, v); }, 5, 8);
  SurfaceOptions options;
  options.luff_extension_mm = 5;
  options.head_extension_mm = 10;
  EXPECT_GT(SurfaceArea(FitSurface(input, options).surface),
            1.2 * SurfaceArea(FitSurface(input).surface));
  for (std::optional<double> SurfaceOptions::*extension_mm :
       {&SurfaceOptions::luff_extension_mm, &SurfaceOptions::leech_extension_mm,
        &SurfaceOptions::foot_extension_mm, &SurfaceOptions::head_extension_mm}) {
    SurfaceOptions large;
    large.*extension_mm = 1e4;
    ExpectThrows<InputError>([&] { FitSurface(input, large); },
                             {"--Surface.", "_extension: 10000 mm, expected at most"});
  }
}

TEST(SurfaceEnds, ReachesTheEdgesThatAreGiven) {
  // Markers inside of 8 % from luff and leech and 10 % from foot and head.
  const auto inner = [](double u, double v) { return TwistedSail(0.08 + 0.84 * u, 0.1 + 0.8 * v); };
  SurfaceOptions options;
  for (int k = 0; k <= 10; ++k) {
    options.edges.luff.points_m.push_back(TwistedSail(0, k / 10.0));
    options.edges.leech.points_m.push_back(TwistedSail(1, k / 10.0));
    options.edges.foot.points_m.push_back(TwistedSail(k / 10.0, 0));
    options.edges.head.points_m.push_back(TwistedSail(k / 10.0, 1));
  }
  const auto fitted = FitSurface(AsExact(MarkersOn(inner, 7, 8)), options);
  const double true_area_m2 = SurfaceArea(FitSurface(MarkersOn(TwistedSail, 16, 16)).surface);
  EXPECT_NEAR(SurfaceArea(fitted.surface), true_area_m2, 0.005 * true_area_m2);
  EXPECT_LT(LargestDistance(fitted.surface, TwistedSail), 0.02);
  for (const auto& edge :
       {options.edges.luff.points_m, options.edges.leech.points_m, options.edges.foot.points_m}) {
    for (const SurfaceFoot& foot : ProjectOnSurface(fitted.surface, edge)) {
      EXPECT_LT(std::hypot(foot.distance_m, foot.beyond_edge_m), 0.01);
    }
  }
  EXPECT_EQ(fitted.residuals.size(), 56u);  // edge points are no markers
}

// Markers inside of 8 % from luff and leech and 10 % from foot and head, with these edges.
SurfaceInput InsideOfItsCloth(double sigma_m, int seed) {
  const auto inner = [](double u, double v) { return TwistedSail(0.08 + 0.84 * u, 0.1 + 0.8 * v); };
  SurfaceInput input = MarkersOn(inner, 7, 12);
  AddNoise(sigma_m, true, seed, &input);
  for (std::size_t j = 0; j < input.lines.size(); ++j) {
    const double v = 0.1 + 0.8 * static_cast<double>(j) / 6;
    input.lines[j].luff_offset_m = (TwistedSail(0.08, v) - TwistedSail(0, v)).norm();
    input.lines[j].leech_offset_m = (TwistedSail(1, v) - TwistedSail(0.92, v)).norm();
  }
  input.foot_offset_m = input.head_offset_m = 0.6;
  return input;
}

TEST(SurfaceEnds, EndsAtTheEdgesOfTheClothWithAGrowingSigma) {
  constexpr double kSigma_m = 0.5e-3;
  const double true_area_m2 = SurfaceArea(FitSurface(MarkersOn(TwistedSail, 16, 16)).surface);
  std::vector<double> errors_in_sigmas;
  for (int seed = 1; seed <= 4; ++seed) {
    const auto fitted = FitSurface(InsideOfItsCloth(kSigma_m, seed));
    EXPECT_NEAR(SurfaceArea(fitted.surface), true_area_m2, 0.02 * true_area_m2);
    std::vector<Eigen::Vector3d> places;
    std::map<std::string, std::vector<double>> sigmas_m;
    for (const SurfaceEdgePoint& point : fitted.edges) {
      ASSERT_TRUE(point.sigma_m);
      sigmas_m[point.edge].push_back(*point.sigma_m);
    }
    for (const auto& [edge, values_m] : sigmas_m) {
      EXPECT_GT(values_m.front(), values_m[values_m.size() / 2]) << edge;
      EXPECT_GT(Median(values_m), kSigma_m) << edge;
    }
    for (int k = 0; k <= 10; ++k) {
      places.push_back(TwistedSail(0, k / 10.0));
      places.push_back(TwistedSail(1, k / 10.0));
    }
    const std::vector<SurfaceFoot> feet = ProjectOnSurface(fitted.surface, places);
    for (std::size_t k = 0; k < feet.size(); ++k) {
      EXPECT_LT(feet[k].beyond_edge_m, 0.03);
      const auto& of_edge = sigmas_m[k % 2 == 0 ? "luff" : "leech"];
      errors_in_sigmas.push_back(feet[k].distance_m / of_edge[4 * (k / 2)]);
    }
    EXPECT_THAT(fitted.notes, Contains(HasSubstr("luff: continued beyond the markers; its sigma")));
  }
  EXPECT_LT(ComputeStatistics(errors_in_sigmas).rms, 3.0);
  EXPECT_GT(ComputeStatistics(errors_in_sigmas).rms, 0.3);
}

TEST(SurfaceEnds, OptionsOutrankTheEdgesOfTheLayout) {
  const SurfaceInput input = InsideOfItsCloth(0.5e-3, 1);
  SurfaceOptions options;
  options.luff_extension_mm = options.leech_extension_mm = 0.0;
  options.foot_extension_mm = options.head_extension_mm = 0.0;
  SurfaceInput without = input;
  for (SurfaceLine& line : without.lines) {
    line.luff_offset_m.reset();
    line.leech_offset_m.reset();
  }
  without.foot_offset_m.reset();
  without.head_offset_m.reset();
  EXPECT_EQ(FitSurface(input, options).surface.poles_in_shape_m,
            FitSurface(without).surface.poles_in_shape_m);
}

TEST(SurfaceEnds, SaysWhichEdgeIsOutOfReach) {
  SurfaceInput input = InsideOfItsCloth(0.5e-3, 1);
  input.head_offset_m = 3;
  input.lines[2].luff_offset_m = 2;
  for (int k = 1; k < 11; ++k) input.lines[0].markers[k].reset();
  const auto fitted = FitSurface(input);
  EXPECT_THAT(fitted.notes,
              Contains(HasSubstr("head: the edge of the cloth is 3 m from the outer")));
  EXPECT_THAT(fitted.notes, Contains(HasSubstr("luff: the edge of the cloth is 2 m from")));
  EXPECT_THAT(fitted.notes,
              Contains(HasSubstr("foot: the edge of the cloth is given from a line")));
  EXPECT_THAT(fitted.notes, Contains(HasSubstr("leech: continued")));
}

}  // namespace
}  // namespace velamap
