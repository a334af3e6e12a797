#include "exporters/curve/section_spline.h"

#include <cmath>

#include <gtest/gtest.h>

#include "importer/geometry/units.h"
#include "tests/exporters/sail/sail_shapes.h"

namespace velamap {
namespace {

constexpr double kCamber = 0.14, kDraft = 0.33;

// A cubic from luff to leech that is deepest at kDraft.
UnitProfile CubicProfile() {
  const double skew = (2 * kDraft - 1) / (2 * kDraft - 3 * kDraft * kDraft);
  const double peak = kDraft * (1 - kDraft) * (1 + skew * kDraft);
  return
      [=](double x) { return Eigen::Vector2d(x, kCamber * x * (1 - x) * (1 + skew * x) / peak); };
}

double EntryAngle_deg() {
  const Eigen::Vector2d start = CubicProfile()(1e-6);
  return std::atan2(start.y(), start.x()) * kDegPerRad;
}

Sail SailOfCubics(int num_markers) {
  return MakeSailOfLines({{0, 3.0, 0, CubicProfile()},
                          {2, 2.4, 6, CubicProfile()},
                          {4, 1.6, 14, CubicProfile()},
                          {5, 1.2, 16, CubicProfile()}},
                         num_markers);
}

void ExpectCubic(const Section& section, double max_residual_m) {
  EXPECT_NEAR(section.camber.value, kCamber, 0.003) << section.name;
  EXPECT_NEAR(section.draft_position->value, kDraft, 0.02) << section.name;
  EXPECT_NEAR(section.entry_angle_deg.value, EntryAngle_deg(), 2.5) << section.name;
  for (const SectionMarker& marker : section.markers) {
    EXPECT_NEAR(marker.residual_m, 0.0, max_residual_m)
        << section.name << " marker " << marker.marker_id;
  }
}

TEST(SectionSpline, LinesOfFourMarkersWithoutSigmasAreNoParabolas) {
  const SectionReport report = SectionsOf(SailOfCubics(4));
  ASSERT_EQ(report.sections.size(), 4u);
  for (const Section& section : report.sections) ExpectCubic(section, 1e-4);
}

TEST(SectionSpline, LongerLinesDecideForThoseOfFourMarkers) {
  Sail sail = SailOfCubics(7);
  for (const int id : {201, 203, 205, 301, 303, 305, 401, 403, 405}) RemoveMarker(id, &sail.shape);
  const SectionReport report = SectionsOf(sail);
  ASSERT_EQ(report.sections.size(), 4u);
  EXPECT_EQ(report.sections[3].markers.size(), 4u);
  for (const Section& section : report.sections) ExpectCubic(section, 1e-3);
}

// On a straight line but for an S of this depth.
CurveData FourPoints(double depth_m) {
  CurveData data;
  data.points_in_shape_m.resize(3, 4);
  data.points_in_shape_m << 0, 1, 2, 3, 0, depth_m, -depth_m, 0, 0, 0, 0, 0;
  return data;
}

// What is smaller than the nominal sigma of 0.1 mm is smoothed away, and what is larger is not.
TEST(SectionSpline, FourPointsAreFollowedToTheNominalSigma) {
  const auto num_parameters = [](double depth_m) {
    const CurveData data = FourPoints(depth_m);
    return FitCurve(data, ChooseSmoothing({data})).num_effective_parameters;
  };
  EXPECT_GT(num_parameters(2e-3), 3.9);
  EXPECT_LT(num_parameters(1e-5), 3.1);
}

TEST(SectionSpline, FourPointsDoNotVote) {
  CurveData seven;
  seven.points_in_shape_m.resize(3, 7);
  for (int i = 0; i < 7; ++i) {
    seven.points_in_shape_m.col(i) << i, 0.3 * std::sin(0.5 * i) + 0.01 * std::cos(7.0 * i), 0;
  }
  EXPECT_EQ(ChooseSmoothing({seven, FourPoints(0.05), FourPoints(0.0)}), ChooseSmoothing({seven}));
}

}  // namespace
}  // namespace velamap
