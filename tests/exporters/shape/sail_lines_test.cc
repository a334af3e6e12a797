#include "exporters/shape/sail_lines.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/exporters/sail/sail_shapes.h"

namespace velamap {
namespace {

using testing::HasSubstr;

// Turns a marker about its normal by quarters.
void Turn(int num_quarters, ShapeMarker* marker) {
  const auto corners = marker->x_in_shape_m.begin() + 1;
  std::rotate(corners, corners + num_quarters, marker->x_in_shape_m.end());
}

Sail WithoutVerticalLines() {
  Sail sail = ExampleSail(8);
  sail.layout.parts[0].vertical.clear();
  return sail;
}

TEST(SailLines, LinesFromHeadToFootAreDoubtful) {
  Sail sail = WithoutVerticalLines();
  EXPECT_EQ(DoubtAboutSailUp(sail.shape, sail.layout), "");
  auto& lines = sail.layout.parts[0].horizontal;
  std::reverse(lines.begin(), lines.end());
  EXPECT_THAT(DoubtAboutSailUp(sail.shape, sail.layout),
              HasSubstr("24 of the 24 markers of 'sail' stand upside down if its lines are in the "
                        "order of the layout; list horizontal lines"));
  // A vertical line from foot to head settles it.
  sail.layout.parts[0].vertical = ExampleSail(8).layout.parts[0].vertical;
  EXPECT_EQ(DoubtAboutSailUp(sail.shape, sail.layout), "");
}

TEST(SailLines, OnlyAClearMajorityOfMarkersUpsideDownIsDoubtful) {
  const Sail sail = WithoutVerticalLines();
  const auto doubt = [&](int num_turned, int num_quarters) {
    MarkerShape shape = sail.shape;
    for (int i = 0; i < num_turned; ++i) Turn(num_quarters, &shape.markers[i]);
    return DoubtAboutSailUp(shape, sail.layout);
  };
  EXPECT_EQ(doubt(12, 2), "");
  EXPECT_THAT(doubt(20, 2), HasSubstr("20 of the 24"));
  // On their sides, they say nothing.
  EXPECT_EQ(doubt(24, 1), "");
  EXPECT_EQ(doubt(24, 3), "");
}

TEST(SailLines, WithoutLinesThereIsNoDoubt) {
  const Sail sail = ExampleSail();
  EXPECT_EQ(DoubtAboutSailUp(sail.shape, Layout()), "");
  EXPECT_EQ(DoubtAboutSailUp(MarkerShape(), sail.layout), "");
}

}  // namespace
}  // namespace velamap
