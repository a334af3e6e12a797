#include "exporters/surface/surface_input.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(SurfaceInput, TakesWholeMarkersByTheirLines) {
  MarkerShape shape;
  for (const int id : {1, 2, 3, 5, 8, 9}) {
    ShapeMarker marker;
    marker.marker_id = id;
    if (id != 9) marker.x_in_shape_m.fill(Eigen::Vector3d(id, 0, 0));
    if (id == 2) marker.sigma_m[0] = Eigen::Vector3d(0.001, 0.002, 0.002);
    shape.markers.push_back(marker);
  }
  LayoutPart part;
  part.horizontal = {{"h1", {1, 4, 2}}, {"h2", {9, 3}}};
  part.vertical = {{"v1", {1, 8}}};
  part.marker_ids = {5};
  part.edges.luff.offsets_m = {0.05, 0.07};
  part.edges.head.offsets_m = {0.2};
  const SurfaceInput input = CollectSurfaceInput(shape, part);
  ASSERT_EQ(input.lines.size(), 2u);
  EXPECT_EQ(input.lines[0].name, "h1");
  ASSERT_EQ(input.lines[0].markers.size(), 3u);
  EXPECT_EQ(input.lines[0].markers[0]->marker_id, 1);
  EXPECT_FALSE(input.lines[0].markers[0]->sigma_m);
  EXPECT_FALSE(input.lines[0].markers[1]);
  EXPECT_NEAR(*input.lines[0].markers[2]->sigma_m, std::sqrt(3e-6), 1e-12);
  EXPECT_FALSE(input.lines[1].markers[0]);  // 9 is not whole
  ASSERT_EQ(input.markers.size(), 2u);
  EXPECT_EQ(input.markers[0].marker_id, 5);
  EXPECT_EQ(input.markers[1].marker_id, 8);
  EXPECT_EQ(input.lines[1].luff_offset_m, 0.07);
  EXPECT_FALSE(input.lines[1].leech_offset_m);
  EXPECT_EQ(input.head_offset_m, 0.2);
  EXPECT_FALSE(input.foot_offset_m);
  // Markers 1 and 8 on the leech.
  part.edges.leech.line = "v1";
  const SurfaceInput with_leech = CollectSurfaceInput(shape, part);
  ASSERT_EQ(with_leech.edges.leech.points_m.size(), 2u);
  EXPECT_EQ(with_leech.edges.leech.points_m[1], Eigen::Vector3d(8, 0, 0));
  ASSERT_EQ(with_leech.markers.size(), 1u);
  EXPECT_EQ(with_leech.markers[0].marker_id, 5);
  EXPECT_EQ(with_leech.leech_note, "");
  // One of them is no edge, and that is said.
  shape.markers.erase(shape.markers.begin() + 4);
  const SurfaceInput one = CollectSurfaceInput(shape, part);
  EXPECT_TRUE(one.edges.leech.points_m.empty());
  EXPECT_EQ(one.leech_note,
            "leech: 1 of the markers of its line v1 are whole, 2 needed; the surface ends at the "
            "outer markers of the other lines");
  EXPECT_EQ(one.luff_note, "");
}

// Markers 1 to 3 and 11 to 13 on lines, 21 and 23 below them and 31 at the luff.
TEST(SurfaceInput, TakesPointsAndLinesAlongTheEdges) {
  MarkerShape shape;
  for (const int id : {1, 2, 3, 11, 12, 13, 21, 23, 31}) {
    ShapeMarker marker;
    marker.marker_id = id;
    const Eigen::Vector3d center_m(id % 10, 0, id > 20 ? -1 : 2.0 * (id / 10));
    marker.x_in_shape_m.fill(center_m);
    marker.x_in_shape_m[4] = center_m - Eigen::Vector3d(0.1, 0, 0.1);
    shape.markers.push_back(marker);
  }
  LayoutPart part;
  part.horizontal = {{"h1", {1, 2, 3}}, {"h2", {11, 12, 13}}};
  part.marker_ids = {21, 23, 31, 99};
  part.edges.luff.points = {{11, 4}, {1, 4}, {99, 0}};
  part.edges.luff.offsets_m = {0.03};
  part.edges.foot.points = {{23, 0}, {21, 0}};
  part.edges.head.line = "h2";
  part.edges.head.offsets_m = {0.25};
  const SurfaceInput input = CollectSurfaceInput(shape, part, Eigen::Vector3d::UnitZ());
  ASSERT_EQ(input.edges.luff.points_m.size(), 2u);  // from foot to head; 99 is missing
  EXPECT_NEAR((input.edges.luff.points_m[0] - Eigen::Vector3d(0.9, 0, -0.1)).norm(), 0, 1e-12);
  EXPECT_EQ(input.edges.luff.beyond_m, 0.03);
  EXPECT_FALSE(input.lines[0].luff_offset_m);
  EXPECT_TRUE(input.edges.luff.is_seen);
  EXPECT_FALSE(input.edges.foot.is_seen);
  ASSERT_EQ(input.edges.foot.points_m.size(), 2u);  // from luff to leech
  EXPECT_EQ(input.edges.foot.points_m[0], Eigen::Vector3d(1, 0, -1));
  EXPECT_EQ(input.edges.foot.beyond_m, 0.0);
  EXPECT_FALSE(input.foot_offset_m);
  EXPECT_EQ(input.head_offset_m, 0.25);
  EXPECT_TRUE(input.edges.head.points_m.empty());
  // Markers on the edge belong to it; where the cloth goes on, they show the surface as well.
  ASSERT_EQ(input.markers.size(), 1u);
  EXPECT_EQ(input.markers[0].marker_id, 31);
  part.edges.foot.offsets_m = {0.05};
  EXPECT_EQ(CollectSurfaceInput(shape, part, Eigen::Vector3d::UnitZ()).markers.size(), 3u);
  // What gives no edge is said.
  part.edges.foot.points = {{23, 0}, {99, 0}};
  part.edges.head.line = "h1";
  const SurfaceInput lacking = CollectSurfaceInput(shape, part, Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(lacking.edges.foot.points_m.empty());
  EXPECT_EQ(lacking.foot_note,
            "foot: 1 of the markers of its points are whole, 2 needed; the surface ends at the "
            "outer markers");
  EXPECT_FALSE(lacking.head_offset_m);
  EXPECT_EQ(lacking.head_note,
            "head: its line h1 is at the other end of the sail; the surface ends at h2");
}

// Two lines of three markers; the vertical line, if there is one, runs from `vertical`'s first.
LayoutPart TwoLines(const std::vector<int>& vertical) {
  LayoutPart part;
  part.horizontal = {{"low", {1, 2, 3}}, {"high", {11, 12, 13}}};
  part.vertical = {{"v1", vertical}};
  part.edges.leech.line = "v1";
  part.edges.luff.offsets_m = {0.05, 0.07};
  part.edges.foot.offsets_m = {0.1};
  part.edges.head.offsets_m = {0.8};
  return part;
}

MarkerShape ShapeOfTwoLines() {
  MarkerShape shape;
  for (const int id : {1, 2, 3, 11, 12, 13}) {
    ShapeMarker marker;
    marker.marker_id = id;
    marker.x_in_shape_m.fill(Eigen::Vector3d(id % 10, 0, 2.0 * (id / 10)));
    shape.markers.push_back(marker);
  }
  return shape;
}

TEST(SurfaceInput, LinesFromHeadToFootGiveTheSameInput) {
  const MarkerShape shape = ShapeOfTwoLines();
  const LayoutPart part = TwoLines({3, 13});
  LayoutPart head_first = TwoLines({13, 3});
  std::reverse(head_first.horizontal.begin(), head_first.horizontal.end());
  std::reverse(head_first.edges.luff.offsets_m.begin(), head_first.edges.luff.offsets_m.end());
  for (const LayoutPart& each : {part, head_first}) {
    const SurfaceInput input = CollectSurfaceInput(shape, each, Eigen::Vector3d::UnitZ());
    EXPECT_EQ(input.lines[0].name, "low");
    EXPECT_EQ(input.lines[1].name, "high");
    EXPECT_EQ(input.lines[0].luff_offset_m, 0.05);
    EXPECT_EQ(input.lines[1].luff_offset_m, 0.07);
    EXPECT_EQ(input.foot_offset_m, 0.1);
    EXPECT_EQ(input.head_offset_m, 0.8);
    EXPECT_EQ(input.edges.leech.points_m.front(), Eigen::Vector3d(3, 0, 0));
    EXPECT_EQ(input.edges.leech.points_m.back(), Eigen::Vector3d(3, 0, 2));
  }
}

TEST(SurfaceInput, WithoutUpTheVerticalLinesTellFootFromHead) {
  LayoutPart part = TwoLines({3, 13});
  std::reverse(part.horizontal.begin(), part.horizontal.end());
  EXPECT_EQ(CollectSurfaceInput(ShapeOfTwoLines(), part).lines[0].name, "low");
  // Without any, the order of the layout holds.
  part.vertical.clear();
  EXPECT_EQ(CollectSurfaceInput(ShapeOfTwoLines(), part).lines[0].name, "high");
}

}  // namespace
}  // namespace velamap
