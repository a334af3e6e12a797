#include "exporters/sail/section.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "tests/exporters/sail/sail_shapes.h"

namespace velamap {
namespace {

using testing::HasSubstr;

void ExpectSameNumbers(const SectionReport& a, const SectionReport& b, double tolerance) {
  ASSERT_EQ(a.sections.size(), b.sections.size());
  for (std::size_t i = 0; i < a.sections.size(); ++i) {
    const auto numbers_a = NumbersOf(a.sections[i]), numbers_b = NumbersOf(b.sections[i]);
    EXPECT_EQ(a.sections[i].name, b.sections[i].name);
    for (std::size_t k = 0; k < numbers_a.size(); ++k) {
      EXPECT_NEAR(numbers_a[k], numbers_b[k], tolerance) << a.sections[i].name << " number " << k;
    }
  }
}

TEST(Section, CircularArcsGiveTheirCamberAnglesAndTwist) {
  const SectionReport report = SectionsOf(ExampleSail());
  ASSERT_EQ(report.sections.size(), 3u);
  EXPECT_TRUE(report.missing.empty());
  EXPECT_TRUE(report.notes.empty());
  EXPECT_EQ(report.rigs.at(0).twist_reference, "lowest section");
  const std::vector<double> chords_m = {3.0, 2.4, 1.6}, cambers = {0.08, 0.10, 0.12};
  const std::vector<double> twists_deg = {0, 6, 14};
  for (std::size_t i = 0; i < 3; ++i) {
    const Section& section = report.sections[i];
    const double angle_deg = 2 * std::atan(2 * cambers[i]) * kDegPerRad;
    EXPECT_NEAR(section.chord_m.value, chords_m[i], 1e-5);
    EXPECT_NEAR(section.camber.value, cambers[i], 1e-5);
    EXPECT_NEAR(section.draft_position->value, 0.5, 1e-5);
    EXPECT_NEAR(section.entry_angle_deg.value, angle_deg, 0.03);
    EXPECT_NEAR(section.exit_angle_deg.value, angle_deg, 0.03);
    EXPECT_NEAR(section.twist_deg->value, twists_deg[i], 1e-5);
    const double radius_m = chords_m[i] / (2 * std::sin(angle_deg * kRadPerDeg));
    EXPECT_NEAR(section.girth_m.value, 2 * radius_m * angle_deg * kRadPerDeg, 1e-5);
    const double lowest_angle_deg = 2 * std::atan(2 * cambers[0]) * kDegPerRad;
    EXPECT_NEAR(section.leech_twist_deg->value, twists_deg[i] - angle_deg + lowest_angle_deg, 0.05);
    EXPECT_NEAR(section.height_m, 2.0 * i, 1e-9);
    EXPECT_EQ(section.markers.size(), 12u);
    EXPECT_FALSE(section.camber.sigma);
  }
}

TEST(Section, SaysWhichEndsOfItsLineAreMissing) {
  Sail sail = ExampleSail();
  for (const int id : {100, 111, 200, 201, 302, 311}) RemoveMarker(id, &sail.shape);
  const SectionReport report = SectionsOf(sail);
  ASSERT_EQ(report.sections.size(), 3u);
  EXPECT_EQ(MissingEndsText(report.sections[0]), "1 marker missing at the luff and 1 at the leech");
  EXPECT_EQ(MissingEndsText(report.sections[1]), "2 markers missing at the luff");
  EXPECT_EQ(MissingEndsText(report.sections[2]), "1 marker missing at the leech");
  EXPECT_LT(report.sections[1].camber.value, 0.095);  // of the whole line: 0.10
  EXPECT_EQ(MissingEndsText(SectionsOf(ExampleSail()).sections[0]), "");
}

TEST(Section, HeightsSayWhichEndsOfTheLinesNextToThemAreMissing) {
  Sail sail = ExampleSail();
  for (const int id : {200, 201, 311}) RemoveMarker(id, &sail.shape);
  SectionOptions options;
  options.heights_m = {1.0, 3.0};
  const SectionReport report = SectionsOf(sail, options);
  ASSERT_EQ(report.sections.size(), 5u);
  EXPECT_EQ(report.sections[1].name, "height=1");
  EXPECT_EQ(MissingEndsText(report.sections[0]), "");
  EXPECT_EQ(MissingEndsText(report.sections[1]), "2 markers missing at the luff");
  EXPECT_EQ(MissingEndsText(report.sections[3]),
            "2 markers missing at the luff and 1 at the leech");
}

TEST(Section, NacaCamberLineGivesDraftPositionAndUnequalAngles) {
  const double camber = 0.12, position = 0.4;
  const SectionReport report = SectionsOf(MakeSailOfLines(
      {{0, 2, 0, NacaCamberLine(camber, position)}, {1, 2, 0, NacaCamberLine(camber, position)}},
      21));
  ASSERT_EQ(report.sections.size(), 2u);
  const Section& section = report.sections[0];
  EXPECT_NEAR(section.camber.value, camber, 2e-4);
  EXPECT_NEAR(section.draft_position->value, position, 0.008);
  EXPECT_NEAR(section.entry_angle_deg.value, std::atan(2 * camber / position) * kDegPerRad, 0.3);
  EXPECT_NEAR(section.exit_angle_deg.value, std::atan(2 * camber / (1 - position)) * kDegPerRad,
              0.3);
}

TEST(Section, StraightTwistedLinesHaveTwistAndNoDraftPosition) {
  const SectionReport report = SectionsOf(MakeSailOfLines(
      {{0, 2, 0, CircularArc(0)}, {1, 1.5, -5, CircularArc(0)}, {2, 1, 21, CircularArc(0)}}, 5));
  ASSERT_EQ(report.sections.size(), 3u);
  for (const Section& section : report.sections) {
    EXPECT_NEAR(section.camber.value, 0, 1e-9);
    EXPECT_NEAR(section.entry_angle_deg.value, 0, 1e-5);
    EXPECT_FALSE(section.draft_position);
  }
  // A flat sail has no leeward side; the sign is that of +y or -y.
  EXPECT_NEAR(std::abs(report.sections[1].twist_deg->value), 5, 1e-6);
  EXPECT_NEAR(report.sections[2].twist_deg->value / report.sections[1].twist_deg->value, -4.2,
              1e-6);
}

TEST(Section, OtherTackGivesTheSameNumbers) {
  ExpectSameNumbers(SectionsOf(ExampleSail(12, 1)), SectionsOf(ExampleSail(12, -1)), 1e-9);
}

TEST(Section, RigidMotionChangesNoNumber) {
  Sail moved = ExampleSail();
  SetSigma(0.002, &moved.shape);
  const SectionOptions options{{1.0, 3.0}};
  const SectionReport before = SectionsOf(moved, options);
  moved.shape = Moved(ArbitraryMotion(), moved.shape);
  const SectionReport after = SectionsOf(moved, options);
  ASSERT_EQ(before.sections.size(), 5u);
  ExpectSameNumbers(before, after, 1e-7);
  for (std::size_t i = 0; i < before.sections.size(); ++i) {
    EXPECT_NEAR(*before.sections[i].camber.sigma, *after.sections[i].camber.sigma, 1e-8);
  }
}

TEST(Section, OrderOfMarkersInTheShapeAndOfLinesInTheLayoutDoesNotMatter) {
  Sail sail = ExampleSail();
  const SectionReport before = SectionsOf(sail);
  // Permutes the ids, because the markers of a shape are sorted.
  for (ShapeMarker& marker : sail.shape.markers) marker.marker_id = 1000 - marker.marker_id;
  std::reverse(sail.shape.markers.begin(), sail.shape.markers.end());
  LayoutPart& part = sail.layout.parts[0];
  for (auto* lines : {&part.horizontal, &part.vertical}) {
    for (MarkerLine& line : *lines) {
      for (int& id : line.marker_ids) id = 1000 - id;
    }
  }
  ExpectSameNumbers(before, SectionsOf(sail), 1e-12);
  // In a frame by markers, the order of the lines does not matter.
  const FrameChoice choice{FrameKind::kMarkers, 900, 889, 700};
  const SectionReport by_markers = SectionsOf(sail, {}, choice);
  std::reverse(part.horizontal.begin(), part.horizontal.end());
  ExpectSameNumbers(by_markers, SectionsOf(sail, {}, choice), 1e-12);
}

TEST(Section, CameraFrameGivesTheSameNumbersButHeights) {
  Sail sail = ExampleSail();
  const SectionReport by_lines = SectionsOf(sail);
  sail.shape = Moved(ArbitraryMotion(), sail.shape);
  const SectionReport by_camera = SectionsOf(sail, {}, FrameChoice{FrameKind::kCamera});
  ASSERT_EQ(by_camera.sections.size(), by_lines.sections.size());
  for (std::size_t i = 0; i < by_lines.sections.size(); ++i) {
    const auto a = NumbersOf(by_lines.sections[i]), b = NumbersOf(by_camera.sections[i]);
    for (std::size_t k = 0; k + 1 < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-7);
  }
}

// A hull with flared topsides stands at an angle to the mast, and so does its frame to the others.
TEST(Section, NumbersDoNotDependOnTheFrame) {
  Sail sail = ExampleSail();
  // A mast that is bent, so that no two of its markers give its direction, and lines that rise.
  for (ShapeMarker& marker : sail.shape.markers) {
    for (auto& x : marker.x_in_shape_m) {
      x->x() -= 0.02 * x->z() * (4 - x->z());
      x->z() += 0.1 * x->x();
    }
  }
  const Eigen::Quaterniond flare(
      Eigen::AngleAxisd(0.35, Eigen::Vector3d(1, 0.2, 0.1).normalized()));
  std::vector<Eigen::Vector3d> hull_centers_m;
  for (int i = 0; i < 6; ++i) {
    hull_centers_m.push_back(flare * Eigen::Vector3d(0.5 * (i / 2), 0, -1.0 - i % 2));
  }
  AddHull(hull_centers_m, &sail);
  const SectionReport by_hull = SectionsOf(sail, {}, FrameChoice{FrameKind::kReferencePart});
  EXPECT_EQ(by_hull.rigs.at(0).up_reference, "luff");
  const ShapeFrame hull_frame = ChooseFrame(sail.shape, sail.layout, std::nullopt);
  const Eigen::Vector3d hull_up =
      hull_frame.frame_from_shape.rotation.conjugate() * *hull_frame.up_in_frame;
  EXPECT_LT(hull_up.z(), std::cos(15 * kRadPerDeg));
  for (const FrameChoice& choice : {FrameChoice{FrameKind::kLines}, FrameChoice{FrameKind::kCamera},
                                    FrameChoice{FrameKind::kMarkers, 11, 15, 10},
                                    FrameChoice{FrameKind::kMarkers, 10, 11, 14}}) {
    const SectionReport report = SectionsOf(sail, {}, choice);
    ASSERT_EQ(report.sections.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = NumbersOf(by_hull.sections[i]), b = NumbersOf(report.sections[i]);
      for (std::size_t k = 0; k + 1 < a.size(); ++k) {
        EXPECT_NEAR(a[k], b[k], 1e-9) << by_hull.sections[i].name << " number " << k;
      }
    }
  }
}

TEST(Section, NegativeCamberIsToWindwardOfTheWholeSail) {
  const Sail sail = MakeSailOfLines(
      {{0, 3, 0, CircularArc(0.1)}, {2, 2, 0, CircularArc(0.1)}, {4, 1, 0, CircularArc(-0.03)}}, 9);
  const SectionReport report = SectionsOf(sail);
  ASSERT_EQ(report.sections.size(), 3u);
  EXPECT_NEAR(report.sections[0].camber.value, 0.1, 1e-4);
  EXPECT_NEAR(report.sections[2].camber.value, -0.03, 1e-4);
  EXPECT_LT(report.sections[2].entry_angle_deg.value, 0);
}

TEST(Section, TwistCountsFromTheBoomWhereTheLayoutHasOne) {
  Sail sail = ExampleSail();
  // 4 degrees to windward of the lowest chord, listed from its end forwards.
  const Eigen::Vector3d aft(std::cos(4 / kDegPerRad), -std::sin(4 / kDegPerRad), 0);
  for (const auto& [id, distance_m] :
       {std::pair(51, 2.5), std::pair(52, 1.5), std::pair(53, 0.2)}) {
    sail.shape.markers.insert(
        sail.shape.markers.begin() + (id - 51),
        UprightMarker(id, "boom", distance_m * aft - Eigen::Vector3d(0, 0, 0.3)));
  }
  LayoutPart boom;
  boom.name = "boom";
  boom.marker_ids = {51, 52, 53};
  sail.layout.parts.push_back(boom);
  SetSigma(0.001, &sail.shape);
  SectionReport report = SectionsOf(sail);
  EXPECT_EQ(report.rigs.at(0).twist_reference, "boom");
  EXPECT_NEAR(report.sections[0].twist_deg->value, 4, 1e-3);
  EXPECT_NEAR(report.sections[2].twist_deg->value, 18, 1e-3);
  EXPECT_GT(*report.sections[0].twist_deg->sigma, 0);

  RemoveMarker(51, &sail.shape);
  RemoveMarker(52, &sail.shape);
  report = SectionsOf(sail);
  EXPECT_EQ(report.rigs.at(0).twist_reference, "lowest section");
  EXPECT_NEAR(report.sections[0].twist_deg->value, 0, 1e-12);
  EXPECT_EQ(*report.sections[0].twist_deg->sigma, 0);
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_THAT(report.notes[0], HasSubstr("boom"));
}

TEST(Section, HeightsBetweenLinesOfOneShapeGiveThatShape) {
  // A cylinder of constant section: every height has the same numbers.
  const Sail sail = MakeSailOfLines({{0, 2, 0, CircularArc(0.1)},
                                     {1, 2, 0, CircularArc(0.1)},
                                     {2.5, 2, 0, CircularArc(0.1)},
                                     {3, 2, 0, CircularArc(0.1)}},
                                    10);
  const SectionReport report = SectionsOf(sail, {{2.0, 0.5, 3.0, 0.5, 3.2}});
  ASSERT_EQ(report.sections.size(), 7u);  // 0, 0.5, 1, 2, 2.5, 3 and the height 3
  for (const Section& section : report.sections) {
    EXPECT_NEAR(section.camber.value, 0.1, 1e-5) << section.name;
    EXPECT_NEAR(section.chord_m.value, 2, 2e-5);
    EXPECT_NEAR(section.entry_angle_deg.value, 2 * std::atan(0.2) * kDegPerRad, 0.05);
  }
  EXPECT_EQ(report.sections[1].name, "height=0.5");
  EXPECT_FALSE(report.sections[1].is_line);
  ASSERT_EQ(report.missing.size(), 1u);
  EXPECT_EQ(report.missing[0].name, "height=3.2");
  EXPECT_THAT(report.missing[0].reason, HasSubstr("from 0.000 to 3.000 m"));
}

TEST(Section, NeighbouringHeightsHaveNamesOfTheirOwn) {
  const SectionReport report = SectionsOf(ExampleSail(), {{1.0, 1.0000001}});
  ASSERT_EQ(report.sections.size(), 5u);
  EXPECT_EQ(report.sections[1].name, "height=1");
  EXPECT_EQ(report.sections[2].name, "height=1.0000001");
}

TEST(Section, HeightOnASlopingSailIsLevel) {
  // The cut through lines that rise towards the leech is horizontal.
  Sail sail = ExampleSail();
  for (ShapeMarker& marker : sail.shape.markers) {
    for (auto& x : marker.x_in_shape_m) x->z() += 0.1 * x->x();
  }
  const SectionReport report = SectionsOf(sail, {{1.5}}, FrameChoice{FrameKind::kCamera});
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout, FrameChoice{FrameKind::kCamera});
  ASSERT_TRUE(frame.up_in_frame);
  const auto cut = std::find_if(report.sections.begin(), report.sections.end(),
                                [](const Section& section) { return !section.is_line; });
  ASSERT_NE(cut, report.sections.end());
  for (const ProfilePoint& point : SampleProfile(*cut, 20)) {
    EXPECT_NEAR(frame.up_in_frame->dot(point.x_in_frame_m), 1.5, 1e-5);
  }
}

TEST(Section, LayoutWithoutLinesIsSaidOnce) {
  Sail sail = ExampleSail();
  sail.layout.parts.clear();
  const SectionReport report = SectionsOf(sail, {{1.0, 2.0}});
  EXPECT_TRUE(report.sections.empty());
  EXPECT_TRUE(report.missing.empty());
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_THAT(report.notes[0], HasSubstr("no horizontal lines"));
}

TEST(Section, BadOptionsAreRefused) {
  EXPECT_THROW((SectionOptions{{std::numeric_limits<double>::quiet_NaN()}}.Check()), InputError);
  EXPECT_THROW((SectionOptions{{}, 3}.Check()), InputError);
  EXPECT_THROW((SectionOptions{std::vector<double>(501, 1.0)}.Check()), InputError);
}

}  // namespace
}  // namespace velamap
