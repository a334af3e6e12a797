#include "workflows/run/run_summary.h"

#include <algorithm>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/exporters/compare/example_comparison.h"

namespace velamap {
namespace {

using testing::HasSubstr;
using testing::Not;

Section SectionOf(const std::string& part, int number) {
  Section section;
  section.part = part;
  section.name = fmt::format("h{}", number);
  section.height_m = number;
  section.camber.value = 0.09;
  section.draft_position = Estimate{0.41, 0.01};
  section.twist_deg = Estimate{1.5 * (number - 1), 0.1};
  return section;
}

// A sail of seven lines over a hull, filmed with a rolling shutter, with edges whose surface has
// notes.
ReconstructionSummary SummaryOfASail() {
  ReconstructionSummary summary;
  summary.num_images = 80;
  summary.num_images_total = 150;
  AdjustmentUncertainty uncertainty;
  uncertainty.rolling_shutter_s = 0.01171;
  uncertainty.rolling_shutter_sigma_s = 0.0001;
  summary.adjustment.uncertainty = uncertainty;
  summary.shape.shape = BoatShape();
  summary.shape.scale.relative_sigma = 0.0011;
  summary.shape.scale.print_sigma = 0.001;
  for (int line = 1; line <= 7; ++line) {
    summary.shape.sail.sections.sections.push_back(SectionOf("sail", line));
  }
  RigNumbers rig;
  rig.part = "sail";
  rig.luff_bend_m = Estimate{0.035, 0.0001};
  rig.luff_sag_m = Estimate{0.004, 0.0002};
  summary.shape.sail.sections.rigs = {rig};
  SailSurface sail;
  sail.part = "sail";
  sail.area_m2 = 6.193;
  summary.shape.sail.surfaces.push_back(sail);
  for (const char* edge : {"luff", "leech", "foot", "head"}) {
    summary.shape.sail.surface_notes.push_back(
        fmt::format("sail: {}: continued beyond the markers", edge));
  }
  PartSurface hull;
  hull.part = "hull";
  hull.surface.area_m2 = 0.3158;
  summary.shape.freeform.surfaces.push_back(hull);
  return summary;
}

std::string TextOf(const ReconstructionSummary& summary) {
  std::ostringstream out;
  PrintSummary(summary, WorkspacePaths{"/regatta"}, out);
  return out.str();
}

TEST(PrintSummary, OfASailIsAtMostTenLines) {
  const std::string text = TextOf(SummaryOfASail());
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 10) << text;
  EXPECT_THAT(text,
              HasSubstr(", known to 0.11 % (1 sigma, of which 0.10 % is assumed for the print); "));
  EXPECT_THAT(text, HasSubstr("images: 80 of 150 used, "));
  EXPECT_THAT(text, HasSubstr("rolling shutter of 11.71 +- 0.10 ms corrected\n"));
  EXPECT_THAT(text,
              HasSubstr("\nsections of sail (3 of 7): h1 at 1.00 m: camber 9.0 % with the draft at "
                        "41 %, twist 0.0 deg; h4 at 4.00 m: camber 9.0 % with the draft at 41 %, "
                        "twist 4.5 deg; h7 at 7.00 m: "));
  EXPECT_THAT(text, HasSubstr("\nsurfaces: sail 6.193 m2, "));
  EXPECT_THAT(text, HasSubstr("; hull 0.3158 m2, known to "));
  EXPECT_THAT(text, HasSubstr("; 4 notes in the report\n"));
  EXPECT_THAT(text, Not(HasSubstr("continued beyond")));
  EXPECT_THAT(text, HasSubstr("\nlook at: /regatta/report.html (in a browser); "));
}

TEST(PrintSummary, EachSailHasItsLine) {
  ReconstructionSummary summary = SummaryOfASail();
  SectionReport& sections = summary.shape.sail.sections;
  for (int line = 1; line <= 2; ++line) sections.sections.push_back(SectionOf("jib", line));
  sections.sections.back().num_missing_at_leech = 2;
  sections.missing = {{"jib", "h3", "3 of its 6 markers whole"},
                      {"jib", "h4", "1 of its 6 markers whole"}};
  sections.notes = {"twist of jib refers to section h2"};
  const std::string text = TextOf(summary);
  EXPECT_THAT(text, HasSubstr("\nsections of sail (3 of 7): h1 "));
  EXPECT_THAT(text, HasSubstr("\nsections of jib: h1 at "));
  EXPECT_THAT(text, HasSubstr("; h2 at 2.00 m: camber 9.0 % with the draft at 41 %, twist 1.5 deg, "
                              "only a part of the chord: 2 markers missing at the leech\n"));
  EXPECT_THAT(text,
              HasSubstr("\nsections missing: 2: 3 of its 6 markers whole (jib h3, jib h4)\n"));
  EXPECT_THAT(text, HasSubstr("\nsections: twist of jib refers to section h2\n"));
}

}  // namespace
}  // namespace velamap
