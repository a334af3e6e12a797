// Lines that give no section.

#include "exporters/sail/section_lines.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/exporters/sail/sail_shapes.h"

namespace velamap {
namespace {

using testing::HasSubstr;

TEST(SectionLines, LineWithTooFewMarkersIsLeftOutWithTheReason) {
  Sail sail = ExampleSail(5);
  RemoveMarker(201, &sail.shape);
  RemoveMarker(203, &sail.shape);
  const SectionReport report = SectionsOf(sail);
  ASSERT_EQ(report.sections.size(), 2u);
  ASSERT_EQ(report.missing.size(), 1u);
  EXPECT_EQ(report.missing[0].name, "h2");
  EXPECT_EQ(report.missing[0].reason, "3 of its 5 markers are reconstructed whole; 4 are needed");
  EXPECT_FALSE(report.missing[0].is_by_layout);
}

TEST(SectionLines, LineThatTheLayoutMakesTooShortIsNoFaultOfTheClip) {
  Sail sail = ExampleSail(5);
  sail.layout.parts[0].horizontal[1].marker_ids.resize(3);
  const SectionReport report = SectionsOf(sail);
  ASSERT_EQ(report.missing.size(), 1u);
  EXPECT_EQ(report.missing[0].reason, "the layout gives it 3 markers; 4 are needed");
  EXPECT_TRUE(report.missing[0].is_by_layout);
}

TEST(SectionLines, BadLinesAreLeftOutWithTheReason) {
  const auto reason = [](const Sail& sail) {
    const SectionReport report = SectionsOf(sail);
    EXPECT_EQ(report.sections.size(), 2u);
    return report.missing.size() == 1 ? report.missing[0].reason : "none";
  };
  Sail reversed = ExampleSail();
  auto& reversed_ids = reversed.layout.parts[0].horizontal[1].marker_ids;
  std::reverse(reversed_ids.begin(), reversed_ids.end());
  EXPECT_THAT(reason(reversed), HasSubstr("from luff to leech"));

  Sail mixed = ExampleSail();
  std::swap(mixed.layout.parts[0].horizontal[2].marker_ids[3],
            mixed.layout.parts[0].horizontal[2].marker_ids[7]);
  EXPECT_THAT(reason(mixed), HasSubstr("marker 304 is not aft of marker 307"));

  Sail double_marker = ExampleSail();
  ShiftMarker(205,
              *double_marker.shape.markers[12 + 4].x_in_shape_m[0] -
                  *double_marker.shape.markers[12 + 5].x_in_shape_m[0],
              &double_marker.shape);
  EXPECT_THAT(reason(double_marker), HasSubstr("markers 204 and 205 are in the same place"));
}

std::vector<std::string> NamesOf(const std::vector<Section>& sections) {
  std::vector<std::string> names;
  for (const Section& section : sections) names.push_back(section.name);
  return names;
}

TEST(SectionLines, NeitherOfTwoSectionsThatCrossIsPrinted) {
  Sail sail = ExampleSail();
  for (int j = 6; j < 12; ++j) ShiftMarker(200 + j, {0, 0, -0.45 * (j - 5)}, &sail.shape);
  const SectionReport report = SectionsOf(sail, {{1.0}});
  EXPECT_THAT(NamesOf(report.sections), testing::ElementsAre("h3"));
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_THAT(report.notes[0], HasSubstr("sections h1 and h2 cross: at 100 % of their length"));
  EXPECT_THAT(report.notes[0], HasSubstr("h1 and h2 left out"));
  ASSERT_EQ(report.missing.size(), 3u);
  EXPECT_THAT(report.missing[0].reason, HasSubstr("h1 and h2 cross"));
  EXPECT_THAT(report.missing[1].reason, HasSubstr("h1 and h2 cross"));
  EXPECT_THAT(report.missing[2].reason, HasSubstr("fewer than two lines"));
}

TEST(SectionLines, OnlyTheSectionThatCrossesTheOthersIsLeftOut) {
  Sail sail = ExampleSail();
  for (int j = 0; j < 12; ++j) ShiftMarker(200 + j, {0, 0, 0.9 * (j - 5)}, &sail.shape);
  const SectionReport report = SectionsOf(sail, {{1.0}});
  EXPECT_THAT(NamesOf(report.sections), testing::ElementsAre("h1", "height=1", "h3"));
  ASSERT_EQ(report.notes.size(), 2u);
  EXPECT_THAT(report.notes[0], HasSubstr("h2 left out"));
  EXPECT_THAT(report.notes[1], HasSubstr("h2 left out"));
}

TEST(SectionLines, SectionInTheOrderOfNoLayoutIsLeftOut) {
  Sail sail = ExampleSail();
  auto& lines = sail.layout.parts[0].horizontal;
  std::reverse(lines.begin(), lines.end());  // head to foot
  EXPECT_EQ(SectionsOf(sail).sections.size(), 3u);
  std::swap(lines[0], lines[1]);
  const SectionReport report = SectionsOf(sail);
  EXPECT_THAT(NamesOf(report.sections), testing::ElementsAre("h1"));
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_THAT(report.notes[0], HasSubstr("h2 and h3 are in the wrong order"));
}

}  // namespace
}  // namespace velamap
