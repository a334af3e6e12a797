#include "exporters/surface/surface.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "tests/exporters/sail/example_surface.h"
#include "tests/support/error_matchers.h"
#include "tests/support/study/sail_study.h"

namespace velamap {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string ErrorOf(const SurfaceInput& input, const SurfaceOptions& options = {}) {
  try {
    FitSurface(input, options);
  } catch (const DataError& error) {
    return error.what();
  }
  return "no DataError";
}

TEST(Surface, BilinearPatchIsExactFromTwoLinesOn) {
  for (const bool is_exact : {false, true}) {
    for (const int num_lines : {2, 3, 4, 7}) {
      const SurfaceInput input = MarkersOn(BilinearPatch, num_lines, 5);
      const auto fitted = FitSurface(is_exact ? AsExact(input) : input);
      EXPECT_LT(LargestDistance(fitted.surface, BilinearPatch), 1e-11) << num_lines;
      EXPECT_LT(LargestResidual(fitted), is_exact ? 1e-12 : 1e-11) << num_lines;
      EXPECT_EQ(fitted.notes.size(), 0u);
    }
  }
}

// A cubic spline interpolates to 5/384 h^4 max|f''''| (Hall and Meyer, 1976); on an arc of radius R
// that is |f''''| = 1/R^3. A factor of 1.5 accounts for the ends without given tangents.
TEST(Surface, CylinderIsAsExactAsCubicSplinesAllow) {
  const double arc_m = 4 * 40 * kRadPerDeg;
  for (const int n : {6, 8, 12, 16}) {
    const double h = arc_m / (n - 1);
    const auto fitted = FitSurface(AsExact(MarkersOn(CylinderSail, 5, n)));
    EXPECT_LT(LargestDistance(fitted.surface, CylinderSail),
              1.5 * 5.0 / 384 * std::pow(h, 4) / std::pow(4, 3))
        << n;
    EXPECT_LT(LargestResidual(fitted), 1e-11);
  }
}

TEST(Surface, SailConvergesWithItsMarkersAndItsResidualsVanish) {
  double coarse_m = 0;
  for (const int n : {6, 12}) {
    for (const bool is_exact : {true, false}) {
      const SurfaceInput input = MarkersOn(TwistedSail, n, n);
      const auto fitted = FitSurface(is_exact ? AsExact(input) : input);
      const double distance_m = LargestDistance(fitted.surface, TwistedSail);
      if (n == 6) {
        coarse_m = distance_m;
        // Between markers that are 1.2 m apart, on lines 1.2 m apart.
        EXPECT_LT(distance_m, is_exact ? 2e-3 : 5e-3);
      } else {
        EXPECT_LT(distance_m, coarse_m / 6);
      }
      EXPECT_LT(LargestResidual(fitted), is_exact ? 1e-8 : 2e-3);
    }
  }
}

// Lines of different length, whose markers do not stand above each other, leave room to swing.
TEST(Surface, FewMarkersWithoutSigmasDoNotMakeItSwing) {
  for (const auto& counts :
       {std::vector<int>{13, 9, 7}, {9, 7, 4}, {5, 5, 5, 4}, {3, 3, 3, 3, 3, 3}}) {
    SurfaceInput input;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const auto num_lines = static_cast<int>(counts.size());
      SurfaceLine line = CornersOn(TwistedSail, num_lines, counts[i], 0.02, 0.01).lines[i];
      for (auto& marker : line.markers) marker->marker_id += 100 * static_cast<int>(i);
      input.lines.push_back(line);
    }
    const FittedSurface fitted = FitSurface(input);
    EXPECT_LT(LargestDistance(fitted.surface, TwistedSail), 0.01) << counts.size() << " lines";
    EXPECT_FALSE(SigmaAt(fitted, 0.5, 0.5).has_value());
    EXPECT_FALSE(DependenceAt(fitted, 0.5, 0.5).has_value());
  }
}

TEST(Surface, SectionsBulgeToOneSideWithoutWiggles) {
  const SplineSurface surface = FitSurface(MarkersOn(TwistedSail, 8, 9)).surface;
  for (double u = 0; u <= 1; u += 0.02) {
    for (double v = 0; v <= 1; v += 0.05) {
      const SurfaceJet jet = EvaluateJet(surface, u, v);
      // The normal points to -y, the hollow side of the sail.
      EXPECT_GT(jet.x_uu.dot(jet.normal), 0) << u << ' ' << v;
    }
  }
}

TEST(Surface, MovesWithItsMarkers) {
  const Eigen::Isometry3d moved_from_shape =
      Eigen::Translation3d(3, -2, 7) *
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -0.5).normalized());
  SurfaceInput input = MarkersOn(TwistedSail, 6, 7);
  AddNoise(0.003, true, 3, &input);
  const auto fitted = FitSurface(input);
  SurfaceInput moved = input;
  ForEachMarker(&moved, [&](SurfaceMarker* marker) {
    marker->x_in_shape_m = moved_from_shape * marker->x_in_shape_m;
  });
  const auto moved_fitted = FitSurface(moved);
  for (Eigen::Index k = 0; k < fitted.surface.poles_in_shape_m.rows(); ++k) {
    const Eigen::Vector3d pole = fitted.surface.poles_in_shape_m.row(k);
    const Eigen::Vector3d moved_pole = moved_fitted.surface.poles_in_shape_m.row(k);
    EXPECT_LT((moved_from_shape * pole - moved_pole).norm(), 1e-8);
  }
  ASSERT_EQ(fitted.residuals.size(), moved_fitted.residuals.size());
  for (std::size_t k = 0; k < fitted.residuals.size(); ++k) {
    EXPECT_NEAR(fitted.residuals[k].distance_m, moved_fitted.residuals[k].distance_m, 1e-8);
  }
}

TEST(Surface, SigmasAndCrossValidationBothComeNearerToTheTruthThanInterpolation) {
  double interpolated = 0, known = 0, validated = 0;
  for (int seed = 1; seed <= 6; ++seed) {
    SurfaceInput input = MarkersOn(TwistedSail, 8, 9);
    AddNoise(0.005, false, seed, &input);
    interpolated += TruthRms(FitSurface(AsExact(input)).surface, TwistedSail) / 6;
    validated += TruthRms(FitSurface(input).surface, TwistedSail) / 6;
    ForEachMarker(&input, [](SurfaceMarker* marker) { marker->sigma_m = 0.005; });
    known += TruthRms(FitSurface(input).surface, TwistedSail) / 6;
  }
  EXPECT_LT(known, 0.8 * interpolated);
  EXPECT_LT(validated, 0.8 * interpolated);
  EXPECT_LT(known, 0.0035);
}

// The vertical line has markers where no horizontal one does, which must not bend the surface more.
TEST(Surface, IsAsCurvedAsTheSailAndNearerThanItsMarkers) {
  constexpr double kSigma_m = 0.5e-3;
  constexpr int kNumSails = 4;
  std::vector<double> curvature_errors, errors_in_sigmas;
  for (unsigned seed = 1; seed <= kNumSails; ++seed) {
    std::mt19937 random(seed);
    const Surface sail = DrawSail(&random);
    const SailLines lines = DrawLines(sail, &random);
    const auto fitted = FitSurface(DrawMarkers(sail, lines, kSigma_m, &random));
    for (const SurfaceError& error : MeasureSurface(fitted.surface, sail, lines)) {
      errors_in_sigmas.push_back(error.distance_m / MarkerSigma(kSigma_m, error.along));
      if (error.is_inside) curvature_errors.push_back(error.found_curvature - error.curvature);
    }
  }
  EXPECT_LT(ComputeStatistics(curvature_errors).rms, 0.05);
  EXPECT_LT(ComputeStatistics(errors_in_sigmas).rms, 1.0);
}

TEST(Surface, AnUncertainMarkerPullsLess) {
  const auto residual = [](double sigma_m) {
    SurfaceInput input = MarkersOn(TwistedSail, 6, 7);
    ForEachMarker(&input, [](SurfaceMarker* marker) { marker->sigma_m = 0.001; });
    input.lines[3].markers[3]->x_in_shape_m.y() += 0.05;
    input.lines[3].markers[3]->sigma_m = sigma_m;
    return FitSurface(input).residuals[3 * 7 + 3];
  };
  EXPECT_EQ(residual(0.05).marker_id, 24);
  EXPECT_EQ(residual(0.05).line, "h4");
  // y points against the normal.
  EXPECT_LT(residual(0.05).distance_m, -0.045);
  // Stated with a sigma of 1 mm, it contradicts the sigmas of all, and draws the surface on.
  EXPECT_GT(residual(0.001).distance_m, residual(0.05).distance_m + 0.005);
}

// Has markers between the lines, around which an interpolating surface oscillates.
TEST(Surface, SigmasThatAreTooSmallDoNotMakeItSwing) {
  SurfaceInput input = MarkersOn(TwistedSail, 7, 12);
  for (int i = 0; i < 24; ++i) {
    input.markers.push_back({500 + i, TwistedSail(0.45, (i + 0.5) / 24), {}});
  }
  const double area_m2 = SurfaceArea(FitSurface(input).surface);
  std::mt19937 random(3);
  std::normal_distribution<double> noise_m(0.0, 0.003);
  ForEachMarker(&input, [&](SurfaceMarker* marker) {
    for (double& x : marker->x_in_shape_m) x += noise_m(random);
    marker->sigma_m = 1e-6;
  });
  const FittedSurface fit = FitSurface(input);
  EXPECT_NEAR(SurfaceArea(fit.surface), area_m2, 0.01 * area_m2);
  EXPECT_GT(fit.distance_m.rms, 0.001);
}

// Markers just above the lines and half a metre off them make an interpolating surface oscillate.
TEST(Surface, MarkersThatLieScatteredBearNone) {
  SurfaceInput input = MarkersOn(TwistedSail, 7, 12);
  for (int j = 0; j < 6; ++j) {
    for (int k = 1; k < 8; ++k) {
      const Eigen::Vector3d x = TwistedSail(k / 8.0, (j + 0.1) / 6);
      input.markers.push_back({500 + 10 * j + k, x + Eigen::Vector3d(0, 0.5, 0), {}});
    }
  }
  EXPECT_THROW(FitSurface(AsExact(input)), DataError);
  ExpectThrows<DataError>([&] { FitSurface(AsExact(input)); },
                          {"oscillate between the markers", "m2"});
}

TEST(Surface, MarkersBetweenTheLinesTakePart) {
  // The sail is 3 cm fuller half way between neighbouring lines.
  const auto bulging = [](double u, double v) -> Eigen::Vector3d {
    const double bulge_m = 0.03 * std::sin(kPi * u) * std::pow(std::sin(3 * kPi * v), 2);
    return TwistedSail(u, v) + Eigen::Vector3d(0, bulge_m, 0);
  };
  SurfaceInput input = MarkersOn(bulging, 4, 9);
  const double without_m = TruthRms(FitSurface(AsExact(input)).surface, bulging);
  for (int j = 0; j < 3; ++j) {
    for (int k = 1; k < 8; ++k) {
      input.markers.push_back({100 + 10 * j + k, bulging(k / 8.0, (j + 0.5) / 3), {}});
    }
  }
  const auto fitted = FitSurface(AsExact(input));
  EXPECT_GT(without_m, 0.01);
  EXPECT_LT(TruthRms(fitted.surface, bulging), 0.4 * without_m);
  EXPECT_EQ(fitted.distance_m.count, 4 * 9 + 3 * 7);
  EXPECT_LT(LargestResidual(fitted), 1e-5);
  for (const SurfaceResidual& residual : fitted.residuals) {
    EXPECT_TRUE(residual.is_used);
    EXPECT_EQ(residual.line.empty(), residual.marker_id >= 100);
  }
}

TEST(Surface, MarkerBesideTheSurfaceIsReportedAndLeftOut) {
  SurfaceInput input = MarkersOn(BilinearPatch, 3, 4);
  input.markers.push_back({50, Eigen::Vector3d(-0.4, 0, 0), {}});
  const auto fitted = FitSurface(input);
  EXPECT_EQ(fitted.residuals.back().marker_id, 50);
  EXPECT_FALSE(fitted.residuals.back().is_used);
  EXPECT_NEAR(fitted.residuals.back().beyond_edge_m, 0.4, 0.01);
  EXPECT_EQ(fitted.distance_m.count, 12);
  EXPECT_THAT(fitted.notes,
              ElementsAre(HasSubstr("outside the edge of the surface, not used: 50")));
}

TEST(Surface, HolesAreBridgedAndNamed) {
  SurfaceInput input = MarkersOn(TwistedSail, 8, 9);
  for (const int k : {3, 4, 5}) input.lines[3].markers[k].reset();
  for (const int k : {0, 1}) input.lines[5].markers[k].reset();
  const auto fitted = FitSurface(AsExact(input));
  EXPECT_LT(LargestDistance(fitted.surface, TwistedSail), 0.02);
  EXPECT_LT(TruthRms(fitted.surface, TwistedSail), 0.004);
  EXPECT_THAT(fitted.notes, Contains(HasSubstr("line h4: gap of 1.07 m")));
  EXPECT_THAT(fitted.notes, Contains(HasSubstr("between markers 29 and 33 (3 of the layout")));
  EXPECT_THAT(fitted.notes,
              Contains(HasSubstr("line h6: 2 markers missing at the luff; the surface")));
}

TEST(Surface, LineWithTooFewMarkersIsLeftOutAndItsMarkersStillCount) {
  SurfaceInput input = MarkersOn(TwistedSail, 5, 6);
  for (int k = 1; k < 5; ++k) input.lines[2].markers[k].reset();
  input.lines[2].markers[2] = SurfaceMarker{14, TwistedSail(0.4, 0.5), {}};
  input.lines[2].markers[0].reset();
  const auto fitted = FitSurface(input);
  EXPECT_THAT(fitted.notes, Contains(HasSubstr("line h3: 2 of its 6 markers whole, 3 needed")));
  const auto found =
      std::find_if(fitted.residuals.begin(), fitted.residuals.end(),
                   [](const SurfaceResidual& residual) { return residual.marker_id == 14; });
  ASSERT_NE(found, fitted.residuals.end());
  EXPECT_TRUE(found->is_used);
  EXPECT_EQ(found->line, "");
}

TEST(Surface, TooFewLinesSayWhy) {
  EXPECT_THAT(ErrorOf(MarkersOn(TwistedSail, 2, 5)), "no DataError");
  SurfaceInput input = MarkersOn(TwistedSail, 2, 5);
  for (int k = 0; k < 3; ++k) input.lines[1].markers[k].reset();
  EXPECT_THAT(ErrorOf(input),
              HasSubstr("1 of 2 horizontal lines have 3 whole markers, 2 needed: line h2: 2 of"));
  input.lines.pop_back();
  EXPECT_THAT(ErrorOf(input), HasSubstr("1 of 1 horizontal lines"));
  EXPECT_THAT(ErrorOf(SurfaceInput{}), HasSubstr("0 of 0 horizontal lines"));
}

TEST(Surface, LinesThatCrossOrRunBackwardsAreRefused) {
  SurfaceInput crossing = MarkersOn(BilinearPatch, 3, 5);
  for (int k = 3; k < 5; ++k) crossing.lines[1].markers[k]->x_in_shape_m.z() += 4.5;
  EXPECT_THAT(ErrorOf(crossing), HasSubstr("lines h2 and h3 cross"));
  SurfaceInput backwards = MarkersOn(BilinearPatch, 3, 5);
  std::reverse(backwards.lines[2].markers.begin(), backwards.lines[2].markers.end());
  EXPECT_THAT(ErrorOf(backwards), HasSubstr("lines h2 and h3 run in opposite directions"));
  SurfaceInput doubled = MarkersOn(BilinearPatch, 3, 5);
  doubled.lines[0].markers[2]->x_in_shape_m = doubled.lines[0].markers[1]->x_in_shape_m;
  EXPECT_THAT(ErrorOf(doubled), HasSubstr("line h1: markers 1 and 2 are in the same place"));
}

TEST(Surface, BadOptionsAreNamed) {
  const SurfaceInput input = MarkersOn(BilinearPatch, 3, 5);
  const auto check = [&](const SurfaceOptions& options, const std::string& text) {
    try {
      FitSurface(input, options);
      ADD_FAILURE() << "no error about " << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(text));
    }
  };
  SurfaceOptions negative, single, both;
  negative.head_extension_mm = -100;
  check(negative, "--Surface.head_extension: -100 is out of range");
  single.edges.luff.points_m = {{0, 0, 0}};
  check(single, "luff edge has one point");
  both.edges.foot.points_m = {{0, 0, -1}, {3, 0, -1}};
  both.foot_extension_mm = 500;
  check(both, "give one of the two");
}

}  // namespace
}  // namespace velamap
