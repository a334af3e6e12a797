#include "exporters/surface/surface_input.h"

#include <cmath>

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
  ASSERT_EQ(with_leech.edges.leech.size(), 2u);
  EXPECT_EQ(with_leech.edges.leech[1], Eigen::Vector3d(8, 0, 0));
  ASSERT_EQ(with_leech.markers.size(), 1u);
  EXPECT_EQ(with_leech.markers[0].marker_id, 5);
  EXPECT_EQ(with_leech.leech_note, "");
  // One of them is no edge, and that is said.
  shape.markers.erase(shape.markers.begin() + 4);
  const SurfaceInput one = CollectSurfaceInput(shape, part);
  EXPECT_TRUE(one.edges.leech.empty());
  EXPECT_EQ(one.leech_note,
            "leech: 1 of the markers of its line v1 are whole, 2 needed; the surface ends at the "
            "outer markers of the other lines");
  EXPECT_EQ(one.luff_note, "");
}

}  // namespace
}  // namespace velamap
