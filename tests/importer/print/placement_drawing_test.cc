#include "importer/print/placement_drawing.h"

#include <algorithm>
#include <cctype>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "importer/print/paper.h"

namespace velamap {
namespace {

// About what the letters of a text cover.
Eigen::AlignedBox2d BoxOf(const Text& text) {
  const double width_mm = 0.6 * text.size_mm * static_cast<double>(text.text.size());
  const double share = text.anchor == TextAnchor::kStart ? 0.0
                       : text.anchor == TextAnchor::kEnd ? 1.0
                                                         : 0.5;
  const Eigen::Vector2d left = text.position_mm - Eigen::Vector2d(share * width_mm, 0);
  return {left - Eigen::Vector2d(0, 0.73 * text.size_mm), left + Eigen::Vector2d(width_mm, 0)};
}

// The smallest distance of a segment's points from the box, in steps of a thousandth of its length.
double Distance(const Eigen::AlignedBox2d& box, const Eigen::Vector2d& a,
                const Eigen::Vector2d& b) {
  double least_mm = 1e9;
  for (int i = 0; i <= 1000; ++i) {
    least_mm = std::min(least_mm, box.exteriorDistance(a + i / 1000.0 * (b - a)));
  }
  return least_mm;
}

Drawing PictureOf(double luff_m, double foot_m, double leech_m, double length_mm,
                  const std::string& paper) {
  SailPlacementOptions options;
  options.luff_m = luff_m;
  options.foot_m = foot_m;
  options.leech_m = leech_m;
  PlacementPlan plan;
  plan.placement = PlaceOnSail(options, length_mm, 1.5 * length_mm, 0);
  return DrawPlacement(plan, ParsePaper(paper, "")).front();
}

std::vector<Text> NamesOfVerticalLines(const Drawing& picture) {
  std::vector<Text> names;
  for (const Text& text : picture.texts) {
    if (text.text.size() > 1 && text.text[0] == 'v' && std::isdigit(text.text[1]) != 0) {
      names.push_back(text);
    }
  }
  return names;
}

struct SailSize {
  double luff_m, foot_m, leech_m, length_mm;
};

class PlacementDrawing : public testing::TestWithParam<SailSize> {};

TEST_P(PlacementDrawing, NothingStrikesThroughTheNamesOfVerticalLines) {
  const SailSize& sail = GetParam();
  for (const char* paper : {"A4", "A5", "Letter"}) {
    const Drawing picture =
        PictureOf(sail.luff_m, sail.foot_m, sail.leech_m, sail.length_mm, paper);
    const std::vector<Text> names = NamesOfVerticalLines(picture);
    ASSERT_GT(names.size(), 2u);
    const Stroke& edges = picture.strokes.front();
    ASSERT_TRUE(edges.is_closed);
    for (const Text& name : names) {
      const Eigen::AlignedBox2d box = BoxOf(name);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_GT(Distance(box, edges.points_mm[i], edges.points_mm[(i + 1) % 3]), 0.3)
            << paper << ' ' << name.text;
      }
      EXPECT_LT(box.max().y(), picture.height_mm);
      for (const Text& other : picture.texts) {
        if (other.text == name.text) continue;
        EXPECT_FALSE(box.intersects(BoxOf(other)))
            << paper << ": " << name.text << " lies on " << other.text;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sails, PlacementDrawing,
                         testing::Values(SailSize{6, 3, 6.2, 100}, SailSize{6, 3, 6.2, 50},
                                         SailSize{3, 3, 3, 50}, SailSize{10, 4, 10, 150},
                                         SailSize{5, 3, 6.5, 60}, SailSize{2.2, 1.9, 2.6, 40}));

// A line that is too long is drawn smaller than its neighbours.
TEST(PlacementInstructions, LinesOfInstructionsFitOnA4) {
  constexpr double kLetter = 0.485;  // mean width of the letters of a sentence, of the font size
  int num_sentences = 0;
  for (const Text& text : PictureOf(6, 3, 6.2, 100, "A4").texts) {
    if (text.max_width_mm == kAnyWidth) continue;
    ++num_sentences;
    EXPECT_LE(kLetter * text.size_mm * static_cast<double>(text.text.size()), text.max_width_mm)
        << text.text;
  }
  EXPECT_GT(num_sentences, 5);
}

}  // namespace
}  // namespace velamap
