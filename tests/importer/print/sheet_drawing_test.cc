#include "importer/print/sheet_drawing.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace velamap {
namespace {

using ::testing::HasSubstr;

Drawing DrawOn(const std::string& paper, double length_mm, Sheet* sheet) {
  PrintSheetOptions options;
  options.paper = ParsePaper(paper, "");
  const PrintedLook look{LoadDictionary("DICT_4X4_50"), 1};
  std::vector<PrintedMarker> markers;
  for (int id = 0; id < 6; ++id) markers.push_back({id, length_mm, "sail h1, 2 of 3"});
  *sheet = PlanSheets(markers, 6, options).front();
  return DrawSheet(*sheet, look, {"title", 1, 1});
}

int NumLines(const Drawing& drawing, const Eigen::Vector2d& along_mm) {
  return static_cast<int>(
      std::count_if(drawing.strokes.begin(), drawing.strokes.end(), [&](const Stroke& stroke) {
        const Eigen::Vector2d line = stroke.points_mm.back() - stroke.points_mm.front();
        return (line - along_mm).norm() < 1e-9;
      }));
}

TEST(DrawSheet, ScaleIsAsLongAsItSays) {
  for (const auto& [paper, length_mm] : {std::pair("A4", 100), std::pair("Letter", 100),
                                         std::pair("A6", 50), std::pair("62x62", 30)}) {
    Sheet sheet;
    const Drawing drawing = DrawOn(paper, 10, &sheet);
    EXPECT_EQ(NumLines(drawing, {length_mm, 0}), 1) << paper;
    const std::string words = " to be " + std::to_string(length_mm) + " mm long";
    EXPECT_TRUE(std::any_of(drawing.texts.begin(), drawing.texts.end(), [&](const Text& text) {
      return text.text.find(words) != std::string::npos;
    })) << paper;
  }
}

TEST(DrawSheet, ASecondScaleStandsWhereThereIsRoom) {
  Sheet sheet;
  EXPECT_EQ(NumLines(DrawOn("A4", 100, &sheet), {0, -100}), 1);
  EXPECT_EQ(NumLines(DrawOn("A4", 28, &sheet), {0, -100}), 0);
}

TEST(DrawSheet, MarginsAreWhiteAndNothingIsOutsideThePage) {
  for (const double length_mm : {5.0, 20.0, 40.0, 100.0}) {
    Sheet sheet;
    const Drawing drawing = DrawOn("A4", length_mm, &sheet);
    std::vector<Eigen::Vector2d> ink;
    for (const Stroke& stroke : drawing.strokes) {
      ink.insert(ink.end(), stroke.points_mm.begin(), stroke.points_mm.end());
    }
    for (const Text& text : drawing.texts) {
      if (text.text.empty()) continue;
      // Baseline and upper end of its letters.
      ink.push_back(text.position_mm - Eigen::Vector2d(0, 0.75 * text.size_mm));
      ink.push_back(text.position_mm);
    }
    for (const FilledArea& area : drawing.areas) {
      for (const auto& outline : area.outlines_mm) {
        ink.insert(ink.end(), outline.begin(), outline.end());
      }
    }
    for (const Eigen::Vector2d& point : ink) {
      EXPECT_GT(point.minCoeff(), 0);
      EXPECT_LT(point.x(), drawing.width_mm);
      EXPECT_LT(point.y(), drawing.height_mm);
      for (const Sticker& sticker : sheet.stickers) {
        const Eigen::Vector2d from_center =
            point - sticker.SquareMin() - Eigen::Vector2d::Constant(0.5 * length_mm);
        const double reach = from_center.cwiseAbs().maxCoeff();
        // In the black square, or beyond its margin.
        EXPECT_TRUE(reach <= 0.5 * length_mm + 1e-9 ||
                    reach >= 0.5 * length_mm + sticker.margin_mm - 1e-9)
            << "marker " << sticker.marker.marker_id << " of " << length_mm << " mm: " << point.x()
            << ' ' << point.y();
      }
    }
  }
}

TEST(DrawSheet, StickersSayIdDictionarySizeAndPlace) {
  Sheet sheet;
  const Drawing drawing = DrawOn("A4", 40, &sheet);
  std::string all;
  for (const Text& text : drawing.texts) all += text.text + "\n";
  for (const Sticker& sticker : sheet.stickers) {
    EXPECT_THAT(all, HasSubstr("\n" + std::to_string(sticker.marker.marker_id) + "\n"));
  }
  EXPECT_THAT(all, HasSubstr("DICT_4X4_50, 40 mm"));
  EXPECT_THAT(all, HasSubstr("sail h1, 2 of 3"));
  EXPECT_THAT(all, HasSubstr("up"));
}

TEST(LengthText, HasNoMoreDigitsThanItNeeds) {
  EXPECT_EQ(LengthText(100), "100 mm");
  EXPECT_EQ(LengthText(2.4), "2.4 mm");
  EXPECT_EQ(LengthText(12.3456), "12.346 mm");
}

}  // namespace
}  // namespace velamap
