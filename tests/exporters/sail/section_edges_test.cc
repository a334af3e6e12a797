#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "exporters/sail/section.h"
#include "importer/geometry/units.h"
#include "tests/exporters/sail/sail_shapes.h"

namespace velamap {
namespace {

// Markers at equal steps, the outer ones one step inside luff and leech, whose distances the layout
// gives.
Sail WithinEdges(Sail sail) {
  LayoutPart& part = sail.layout.parts.front();
  part.vertical.clear();
  for (MarkerLine& line : part.horizontal) {
    const auto x_m = [&](std::size_t i) {
      return *FindWholeMarker(sail.shape, line.marker_ids[i])->x_in_shape_m[0];
    };
    const std::size_t last = line.marker_ids.size() - 1;
    part.edges.luff.offsets_m.push_back((x_m(1) - x_m(0)).norm());
    part.edges.leech.offsets_m.push_back((x_m(last) - x_m(last - 1)).norm());
    for (const int id : {line.marker_ids.front(), line.marker_ids.back()}) {
      RemoveMarker(id, &sail.shape);
    }
    line.marker_ids.erase(line.marker_ids.begin());
    line.marker_ids.pop_back();
  }
  return sail;
}

Sail NacaSail(int num_markers) {
  return MakeSailOfLines({{0.0, 3.0, 0.0, NacaCamberLine(0.09, 0.45)},
                          {2.0, 2.4, 6.0, NacaCamberLine(0.1, 0.42)},
                          {4.0, 1.6, 14.0, NacaCamberLine(0.12, 0.4)}},
                         num_markers);
}

TEST(SectionEdges, SectionsOfMarkersWithinTheEdgesAreThoseOfTheWholeCloth) {
  SectionOptions options;
  options.heights_m = {1.0};
  const SectionReport whole = SectionsOf(ExampleSail(17), options);
  const SectionReport within = SectionsOf(WithinEdges(ExampleSail(17)), options);
  ASSERT_EQ(within.sections.size(), 4u);
  EXPECT_EQ(within.notes, std::vector<std::string>(
                              {"sections of sail go on beyond the outer markers, to the edge of "
                               "the cloth at luff and leech"}));
  for (std::size_t i = 0; i < within.sections.size(); ++i) {
    const Section& a = within.sections[i];
    const Section& b = whole.sections[i];
    EXPECT_TRUE(a.reaches_luff && a.reaches_leech);
    EXPECT_FALSE(b.reaches_luff || b.reaches_leech);
    if (!a.is_line) {  // the luff of these markers leans, and heights count along it
      EXPECT_NEAR(a.chord_m.value, b.chord_m.value, 0.03);
      continue;
    }
    EXPECT_NEAR(a.chord_m.value, b.chord_m.value, 2e-3);
    EXPECT_NEAR(a.camber.value, b.camber.value, 2e-4);
    EXPECT_NEAR(a.draft_position->value, b.draft_position->value, 2e-3);
    EXPECT_NEAR(a.entry_angle_deg.value, b.entry_angle_deg.value, 0.1);
    EXPECT_NEAR(a.exit_angle_deg.value, b.exit_angle_deg.value, 0.1);
    EXPECT_NEAR(a.twist_deg->value, b.twist_deg->value, 0.02);
    EXPECT_NEAR(a.leech_twist_deg->value, b.leech_twist_deg->value, 0.1);
    EXPECT_NEAR(a.girth_m.value, b.girth_m.value, 2e-3);
  }
}

// The layout gives the distances from its own outer markers.
TEST(SectionEdges, ASectionWithoutItsOuterMarkerEndsAtTheNextOne) {
  Sail sail = WithinEdges(ExampleSail());
  RemoveMarker(sail.layout.parts.front().horizontal[0].marker_ids.front(), &sail.shape);
  const SectionReport report = SectionsOf(sail);
  EXPECT_FALSE(report.sections[0].reaches_luff);
  EXPECT_TRUE(report.sections[0].reaches_leech);
  EXPECT_TRUE(report.sections[1].reaches_luff);
  EXPECT_LT(report.sections[0].chord_m.value, 2.6);
}

TEST(SectionEdges, AnEdgeOfMarkersIsReachedByThem) {
  Sail sail = ExampleSail();
  LayoutPart& part = sail.layout.parts.front();
  part.edges.luff.line = "v1";
  const double chord_m = SectionsOf(sail).sections[0].chord_m.value;
  EXPECT_TRUE(SectionsOf(sail).sections[0].reaches_luff);
  EXPECT_NEAR(chord_m, 3.0, 1e-5);
  part.edges.luff.offsets_m = {0.05};
  EXPECT_NEAR(SectionsOf(sail).sections[0].chord_m.value, chord_m + 0.05 * std::cos(0.31), 1e-3);
}

// Other markers stand on luff and leech between the lines, as markers do that are glued there
// later.
TEST(SectionEdges, SectionsGoOnToAnEdgeOfPoints) {
  const Sail whole = ExampleSail(17);
  Sail sail = WithinEdges(whole);
  LayoutPart& part = sail.layout.parts.front();
  part.edges = {};
  const auto add_points = [&](double share, bool is_luff, ClothEdge* edge) {
    const auto x_m = [&](std::size_t line) -> Eigen::Vector3d {
      const std::vector<int>& ids = whole.layout.parts.front().horizontal[line].marker_ids;
      return *FindWholeMarker(whole.shape, is_luff ? ids.front() : ids.back())->x_in_shape_m[0];
    };
    const int id = 900 + static_cast<int>(sail.shape.markers.size());
    ShapeMarker marker = sail.shape.markers.front();
    const Eigen::Vector3d shift = (1 - share) * x_m(0) + share * x_m(2) - *marker.x_in_shape_m[0];
    marker.marker_id = id;
    for (auto& point : marker.x_in_shape_m) *point += shift;
    sail.shape.markers.push_back(marker);
    part.marker_ids.push_back(id);
    edge->points.push_back({id, 0});
  };
  for (const double share : {1.0, 0.7, 0.3, 0.0}) add_points(share, true, &part.edges.luff);
  for (const double share : {0.0, 0.3, 0.7, 1.0}) add_points(share, false, &part.edges.leech);
  const SectionReport expected = SectionsOf(whole), report = SectionsOf(sail);
  ASSERT_EQ(report.sections.size(), 3u);
  for (const std::size_t i : {0, 2}) {  // the lines between which the points lie in a line
    const Section &a = report.sections[i], &b = expected.sections[i];
    EXPECT_TRUE(a.reaches_luff && a.reaches_leech);
    EXPECT_NEAR(a.chord_m.value, b.chord_m.value, 2e-3);
    EXPECT_NEAR(a.camber.value, b.camber.value, 2e-4);
  }
}

// A luff that ends below the highest line.
TEST(SectionEdges, AnEdgeThatDoesNotPassALineIsNotReached) {
  Sail sail = WithinEdges(ExampleSail());
  LayoutPart& part = sail.layout.parts.front();
  part.edges = {};
  part.edges.luff.points = {{part.horizontal[0].marker_ids.front(), 0},
                            {part.horizontal[1].marker_ids.front(), 0}};
  const SectionReport report = SectionsOf(sail);
  EXPECT_TRUE(report.sections[0].reaches_luff && report.sections[1].reaches_luff);
  EXPECT_FALSE(report.sections[2].reaches_luff);
}

TEST(SectionEdges, AnEdgeFartherThanHalfOfTheLineIsNotReached) {
  Sail sail = ExampleSail();
  sail.layout.parts.front().edges.leech.offsets_m = {2.0};
  const SectionReport report = SectionsOf(sail);
  EXPECT_FALSE(report.sections[0].reaches_leech);
  EXPECT_NEAR(report.sections[0].chord_m.value, 3.0, 1e-5);
}

// The curvature of these sections changes, at one place even by a jump.
TEST(SectionEdges, ErrorsAreWithinTheirSigmas) {
  constexpr int kNumDraws = 40;
  constexpr double kNoise_m = 1e-3;
  const SectionReport truth = SectionsOf(NacaSail(65));
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  double chord = 0.0, camber = 0.0, entry = 0.0, exit = 0.0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    Sail sail = WithinEdges(NacaSail(14));
    const std::vector<ShapeMarker> markers = sail.shape.markers;
    for (const ShapeMarker& marker : markers) {
      ShiftMarker(marker.marker_id,
                  kNoise_m * Eigen::Vector3d(normal(random), normal(random), normal(random)),
                  &sail.shape);
    }
    SetSigma(kNoise_m, &sail.shape);
    const SectionReport report = SectionsOf(sail);
    for (std::size_t i = 0; i < report.sections.size(); ++i) {
      const auto square = [](const Estimate& found, const Estimate& expected) {
        return std::pow((found.value - expected.value) / found.sigma.value(), 2);
      };
      const double share = 1.0 / static_cast<double>(kNumDraws * report.sections.size());
      const Section &found = report.sections[i], &expected = truth.sections[i];
      chord += share * square(found.chord_m, expected.chord_m);
      camber += share * square(found.camber, expected.camber);
      entry += share * square(found.entry_angle_deg, expected.entry_angle_deg);
      exit += share * square(found.exit_angle_deg, expected.exit_angle_deg);
    }
  }
  EXPECT_NEAR(chord, 1.0, 0.5);
  EXPECT_NEAR(camber, 1.0, 0.5);
  EXPECT_NEAR(entry, 1.0, 0.5);
  EXPECT_NEAR(exit, 1.0, 0.5);
}

}  // namespace
}  // namespace velamap
