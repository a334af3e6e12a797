#include "importer/layout/layout_writer.h"

#include <fstream>
#include <optional>

#include <gtest/gtest.h>

#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

Layout RichLayout() {
  Layout layout = MakeLayout("DICT_5X5_100", 0.1);
  layout.marker_lengths_m = {{7, 0.05}, {40, 0.12345678901234567}};
  layout.drawn_length_m = 0.1005;
  layout.border_bits = 2;
  layout.parts.push_back(
      {"sail: main", false, {{"h1", {1, 2, 3}}, {"h#2", {7, 8, 9}}}, {{"v 1", {1, 7}}}, {30, 31}});
  layout.parts.push_back({"hull", true, {}, {}, {40, 41, 42}});
  layout.reference_part = "hull";
  layout.frame = FrameChoice{FrameKind::kMarkers, 1, 3, 7};
  ClothEdges& edges = layout.parts.front().edges;
  edges.luff.offsets_m.assign(layout.parts.front().horizontal.size(), 0.0625);
  edges.leech.line = layout.parts.front().vertical.front().name;
  edges.leech.offsets_m = {0.015};
  edges.foot.points = {{1, 4}, {30, 0}, {3, 3}};
  edges.head.offsets_m = {0.1};
  layout.distances = {{1, 0, 9, 0, 2.315, 0.002, false}, {1, 1, 40, 4, 1.5, 0.001, true}};
  layout.known_points = {{1, 0, {0.1, -2.0, 3.25}, 0.002, false},
                         {40, 3, {std::nullopt, std::nullopt, 1e-3}, 0.001, true}};
  return layout;
}

void ExpectEqual(const std::vector<MarkerLine>& a, const std::vector<MarkerLine>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].marker_ids, b[i].marker_ids);
  }
}

TEST(LayoutText, ReadsBackAsItWas) {
  const TempDir dir;
  const Layout layout = RichLayout();
  const std::string path = dir / "layout.yml";
  std::ofstream(path) << LayoutText(layout, "two lines\nof comment: {");
  const Layout read = ReadLayout(path);
  EXPECT_EQ(read.dictionary, layout.dictionary);
  EXPECT_EQ(read.marker_length_m, layout.marker_length_m);
  EXPECT_EQ(read.marker_lengths_m, layout.marker_lengths_m);
  EXPECT_EQ(read.drawn_length_m, layout.drawn_length_m);
  EXPECT_EQ(read.border_bits, layout.border_bits);
  EXPECT_EQ(read.reference_part, layout.reference_part);
  ASSERT_EQ(read.parts.size(), layout.parts.size());
  for (std::size_t i = 0; i < layout.parts.size(); ++i) {
    EXPECT_EQ(read.parts[i].name, layout.parts[i].name);
    EXPECT_EQ(read.parts[i].rigid, layout.parts[i].rigid);
    EXPECT_EQ(read.parts[i].marker_ids, layout.parts[i].marker_ids);
    ExpectEqual(read.parts[i].horizontal, layout.parts[i].horizontal);
    ExpectEqual(read.parts[i].vertical, layout.parts[i].vertical);
  }
  const ClothEdges &edges = layout.parts.front().edges, &read_edges = read.parts.front().edges;
  EXPECT_EQ(read_edges.luff.offsets_m, edges.luff.offsets_m);
  EXPECT_EQ(read_edges.leech.line, edges.leech.line);
  EXPECT_EQ(read_edges.leech.offsets_m, edges.leech.offsets_m);
  EXPECT_EQ(read_edges.foot.points, edges.foot.points);
  EXPECT_TRUE(read_edges.foot.offsets_m.empty());
  EXPECT_EQ(read_edges.head.offsets_m, edges.head.offsets_m);
  ASSERT_TRUE(read.frame.has_value());
  EXPECT_EQ(read.frame->plane_id, 7);
  ASSERT_EQ(read.distances.size(), 2u);
  EXPECT_EQ(read.distances[1].corner2, 4);
  EXPECT_EQ(read.distances[1].sigma_m, 0.001);
  EXPECT_TRUE(read.distances[1].is_scale_bar);
  EXPECT_FALSE(read.distances[0].is_scale_bar);
  ASSERT_EQ(read.known_points.size(), layout.known_points.size());
  for (std::size_t i = 0; i < read.known_points.size(); ++i) {
    EXPECT_EQ(read.known_points[i].marker_id, layout.known_points[i].marker_id);
    EXPECT_EQ(read.known_points[i].corner, layout.known_points[i].corner);
    EXPECT_EQ(read.known_points[i].x_m, layout.known_points[i].x_m);
    EXPECT_EQ(read.known_points[i].sigma_m, layout.known_points[i].sigma_m);
    EXPECT_EQ(read.known_points[i].is_check, layout.known_points[i].is_check);
  }
}

TEST(LayoutText, WithoutPartsEveryMarkerIsAccepted) {
  const TempDir dir;
  const std::string path = dir / "layout.yml";
  Layout layout = MakeLayout("DICT_4X4_50", 0.0024);
  layout.frame = FrameChoice{FrameKind::kCamera};
  std::ofstream(path) << LayoutText(layout, "");
  const Layout read = ReadLayout(path);
  EXPECT_FALSE(read.HasMarkers());
  EXPECT_EQ(read.marker_length_m, 0.0024);
  EXPECT_EQ(read.frame->kind, FrameKind::kCamera);
}

}  // namespace
}  // namespace velamap
