#include "importer/print/sheet_plan.h"

#include <set>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

std::vector<PrintedMarker> Markers(int count, double length_mm) {
  std::vector<PrintedMarker> markers;
  for (int id = 0; id < count; ++id) markers.push_back({id, length_mm, ""});
  return markers;
}

PrintSheetOptions On(const std::string& paper) {
  PrintSheetOptions options;
  options.paper = ParsePaper(paper, "--Sheet.paper");
  return options;
}

bool Overlap(const Sticker& a, const Sticker& b) {
  return a.min_mm.x() < b.min_mm.x() + b.Width() && b.min_mm.x() < a.min_mm.x() + a.Width() &&
         a.min_mm.y() < b.min_mm.y() + b.Height() && b.min_mm.y() < a.min_mm.y() + a.Height();
}

TEST(ParsePaper, KnowsNamesAndSizes) {
  EXPECT_EQ(ParsePaper("a4", "").width_mm, 210);
  EXPECT_EQ(ParsePaper("A3", "").height_mm, 420);
  EXPECT_EQ(ParsePaper("letter", "").width_mm, 215.9);
  EXPECT_EQ(ParsePaper("330x480.5", "").height_mm, 480.5);
  for (const char* bad : {"", "A9", "10x10", "330", "330x", "x480", "330x480mm", "nanx100"}) {
    ExpectThrows<InputError>([&] { ParsePaper(bad, "--Sheet.paper"); },
                             {"--Sheet.paper: '" + std::string(bad) + "'", "330x480"});
  }
}

TEST(PlanSheets, EveryMarkerOnceInsideThePageAndApart) {
  for (const char* paper : {"A4", "A3", "Letter", "A5", "500x300"}) {
    for (const double length_mm : {5.0, 17.3, 40.0, 80.0}) {
      const std::vector<Sheet> sheets = PlanSheets(Markers(23, length_mm), 6, On(paper));
      std::multiset<int> ids;
      for (const Sheet& sheet : sheets) {
        for (std::size_t i = 0; i < sheet.stickers.size(); ++i) {
          const Sticker& sticker = sheet.stickers[i];
          ids.insert(sticker.marker.marker_id);
          EXPECT_GE(sticker.min_mm.x(), sheet.frame.min_mm.x() - 1e-6);
          EXPECT_GE(sticker.min_mm.y(), sheet.frame.min_mm.y() - 1e-6);
          EXPECT_LE(sticker.min_mm.x() + sticker.Width(), sheet.frame.max_mm.x() + 2e-3);
          EXPECT_LE(sticker.min_mm.y() + sticker.Height(), sheet.frame.max_mm.y() + 2e-3);
          for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(Overlap(sticker, sheet.stickers[j]));
        }
      }
      EXPECT_EQ(ids.size(), 23u);
      EXPECT_EQ(std::set<int>(ids.begin(), ids.end()).size(), 23u);
    }
  }
}

TEST(PlanSheets, MarginIsWhatSearchAndFitWant) {
  // A quarter of the side pulls no corner; one and a half cells are as far as the fit looks.
  EXPECT_DOUBLE_EQ(DefaultMargin(100, 8), 25);
  EXPECT_DOUBLE_EQ(DefaultMargin(100, 6), 25);
  EXPECT_DOUBLE_EQ(DefaultMargin(100, 5), 30);
  PrintSheetOptions options = On("A4");
  EXPECT_DOUBLE_EQ(PlanSheets(Markers(1, 100), 5, options)[0].stickers[0].margin_mm, 30);
  options.margin_mm = 12.5;
  EXPECT_DOUBLE_EQ(PlanSheets(Markers(1, 100), 5, options)[0].stickers[0].margin_mm, 12.5);
}

TEST(PlanSheets, NumberOnASheetIsLimitedAndPaperTurned) {
  PrintSheetOptions options = On("A4");
  EXPECT_EQ(PlanSheets(Markers(5, 20), 6, options).size(), 1u);
  options.markers_per_sheet = 1;
  EXPECT_EQ(PlanSheets(Markers(5, 20), 6, options).size(), 5u);
  options.markers_per_sheet = 2;
  EXPECT_EQ(PlanSheets(Markers(5, 20), 6, options).size(), 3u);
  // Two of 127 mm lie side by side on turned A4, and one on top of the other on none.
  const std::vector<Sheet> sheets = PlanSheets(Markers(2, 84), 6, On("A4"));
  EXPECT_EQ(sheets.size(), 1u);
  EXPECT_GT(sheets[0].frame.width_mm, sheets[0].frame.height_mm);
}

TEST(PlanSheets, SizesHaveSheetsOfTheirOwn) {
  std::vector<PrintedMarker> markers = Markers(3, 20);
  markers.push_back({7, 50, ""});
  const std::vector<Sheet> sheets = PlanSheets(markers, 6, On("A4"));
  ASSERT_EQ(sheets.size(), 2u);
  EXPECT_EQ(sheets[0].stickers.size(), 3u);
  EXPECT_EQ(sheets[1].stickers[0].marker.marker_id, 7);
}

TEST(PlanSheets, PaperSmallerThanTheMarkerIsAnError) {
  ExpectThrows<InputError>([] { PlanSheets(Markers(1, 200), 6, On("A4")); },
                           {"--Sheet.paper: A4", "marker 0", "300 x 308 mm", "--marker_length"});
  EXPECT_NO_THROW(PlanSheets(Markers(1, 200), 6, On("A2")));
}

TEST(PrintSheetOptions, RangesAreChecked) {
  PrintSheetOptions options;
  EXPECT_NO_THROW(options.Check());
  options.margin_mm = -1;
  ExpectThrows<InputError>([&] { options.Check(); }, {"--Sheet.margin: -1"});
}

}  // namespace
}  // namespace velamap
