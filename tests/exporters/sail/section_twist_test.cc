// Twist counts from the lowest section whose line is whole at both ends.

#include "exporters/sail/section_twist.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/exporters/sail/sail_shapes.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// A boom 4 degrees to windward of the lowest chord.
void AddBoom(Sail* sail) {
  LayoutPart boom;
  boom.name = "boom";
  for (int i = 0; i < 2; ++i) {
    const double aft_m = 0.2 + 2.0 * i;
    const Eigen::Vector3d center_m = aft_m * Eigen::Vector3d(0.99756405, -0.06975647, 0);
    sail->shape.markers.insert(
        sail->shape.markers.begin() + i,
        UprightMarker(51 + i, "boom", center_m - Eigen::Vector3d(0, 0, 0.3)));
    boom.marker_ids.push_back(51 + i);
  }
  sail->layout.parts.push_back(boom);
}

// The twists of ExampleSail() are 0, 6 and 14 degrees.
TEST(SectionTwist, AnIncompleteLowestSectionIsNoReference) {
  const SectionReport whole = SectionsOf(ExampleSail());
  for (const std::vector<int>& missing :
       {std::vector<int>{100, 101, 102}, std::vector<int>{108, 109, 110, 111}}) {
    Sail sail = ExampleSail();
    SetSigma(1e-5, &sail.shape);
    for (const int id : missing) RemoveMarker(id, &sail.shape);
    const SectionReport report = SectionsOf(sail);
    ASSERT_EQ(report.sections.size(), 3u);
    EXPECT_NEAR(report.sections[1].twist_deg->value, 0, 1e-12);
    EXPECT_EQ(report.sections[1].twist_deg->sigma, 0.0);
    EXPECT_NEAR(report.sections[2].twist_deg->value, 8, 1e-3);
    EXPECT_GT(report.sections[2].twist_deg->sigma, 0.0);
    EXPECT_NEAR(report.sections[2].leech_twist_deg->value,
                whole.sections[2].leech_twist_deg->value - whole.sections[1].leech_twist_deg->value,
                0.05);
    EXPECT_EQ(report.rigs.at(0).twist_reference, "section h2");
    EXPECT_EQ(report.rigs.at(0).reference_section, "h2");
    EXPECT_THAT(report.notes,
                ElementsAre("twist, leech twist, bend and sag of sail refer to section h2, the "
                            "lowest whose line is whole at both ends"));
  }
}

TEST(SectionTwist, WithoutAWholeLineThereIsNone) {
  Sail sail = ExampleSail();
  for (const int id : {111, 200, 311}) RemoveMarker(id, &sail.shape);
  const SectionReport report = SectionsOf(sail, {{1.0}});
  ASSERT_EQ(report.sections.size(), 4u);
  for (const Section& section : report.sections) {
    EXPECT_FALSE(section.twist_deg) << section.name;
    EXPECT_FALSE(section.leech_twist_deg) << section.name;
    EXPECT_GT(section.camber.value, 0.05) << section.name;
  }
  EXPECT_EQ(report.rigs.at(0).twist_reference, "none");
  EXPECT_EQ(report.rigs.at(0).reference_section, "");
  EXPECT_THAT(report.notes,
              ElementsAre(StartsWith("no twist, leech twist, bend and sag of sail: each of its "
                                     "lines lacks markers at the luff or the leech; film ")));
}

TEST(SectionTwist, FromTheBoomItNeedsNoSection) {
  Sail sail = ExampleSail();
  AddBoom(&sail);
  RemoveMarker(111, &sail.shape);
  SectionReport report = SectionsOf(sail);
  EXPECT_EQ(report.rigs.at(0).twist_reference, "boom");
  EXPECT_EQ(report.rigs.at(0).reference_section, "h2");
  EXPECT_NEAR(report.sections.at(2).twist_deg->value, 18, 1e-3);
  EXPECT_NEAR(report.sections.at(1).leech_twist_deg->value, 0, 1e-12);
  EXPECT_THAT(report.notes,
              ElementsAre(StartsWith("leech twist, bend and sag of sail refer to section h2")));
  for (const int id : {211, 311}) RemoveMarker(id, &sail.shape);
  report = SectionsOf(sail);
  EXPECT_TRUE(report.sections.at(2).twist_deg);
  EXPECT_FALSE(report.sections.at(2).leech_twist_deg);
}

// The line that would be the reference has no section at all.
TEST(SectionTwist, AMissingLowerLineIsSaid) {
  Sail sail = ExampleSail(5);
  for (const int id : {101, 103}) RemoveMarker(id, &sail.shape);
  const SectionReport report = SectionsOf(sail);
  ASSERT_EQ(report.sections.size(), 2u);
  EXPECT_NEAR(report.sections[1].twist_deg->value, 8, 1e-5);
  EXPECT_EQ(report.rigs.at(0).twist_reference, "section h2");
  EXPECT_THAT(report.notes, ElementsAre(HasSubstr("refer to section h2")));
  // A line of which the layout makes no section is in no clip.
  Sail of_layout = ExampleSail(5);
  of_layout.layout.parts[0].horizontal[0].marker_ids.resize(3);
  EXPECT_EQ(SectionsOf(of_layout).rigs.at(0).twist_reference, "lowest section");
}

TEST(SectionTwist, LinesMayBeListedFromTheHead) {
  const FrameChoice upright{FrameKind::kMarkers, 100, 104, 300};
  for (const auto& [first_id, reference] :
       {std::pair(100, "section h2"), std::pair(300, "lowest section")}) {
    Sail sail = ExampleSail(5);
    auto& lines = sail.layout.parts[0].horizontal;
    std::reverse(lines.begin(), lines.end());
    for (const int place : {1, 3}) RemoveMarker(first_id + place, &sail.shape);
    const SectionReport report = SectionsOf(sail, {}, upright);
    ASSERT_EQ(report.sections.size(), 2u);
    EXPECT_EQ(report.rigs.at(0).twist_reference, reference);
    EXPECT_THAT(report.missing.size(), 1u);
  }
}

TEST(SectionTwist, AWholeSailHasNoNote) {
  Sail sail = ExampleSail();
  RemoveMarker(105, &sail.shape);  // between the ends
  EXPECT_THAT(SectionsOf(sail).notes, IsEmpty());
}

}  // namespace
}  // namespace velamap
