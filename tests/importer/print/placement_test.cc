#include "importer/print/placement.h"

#include <map>
#include <random>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/geometry/quad.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

constexpr double kLength_mm = 100, kSticker_mm = 158;

SailPlacementOptions Sail(double luff_m, double foot_m, double leech_m) {
  SailPlacementOptions options;
  options.luff_m = luff_m;
  options.foot_m = foot_m;
  options.leech_m = leech_m;
  return options;
}

// Distance to the nearest edge; negative outside.
double DistanceToEdge(const std::vector<Eigen::Vector2d>& triangle, const Eigen::Vector2d& point) {
  double least = 1e9;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector2d side = triangle[(i + 1) % 3] - triangle[i];
    least = std::min(least, Cross(side, point - triangle[i]) / side.norm());
  }
  return least;
}

TEST(PlaceOnSail, TriangleHasTheGivenSides) {
  const Placement placement = PlaceOnSail(Sail(6, 3, 6.2), kLength_mm, kSticker_mm, 0);
  const auto& corners = placement.sail_mm;  // tack, clew, head
  EXPECT_NEAR((corners[1] - corners[0]).norm(), 3000, 1e-6);
  EXPECT_NEAR((corners[2] - corners[0]).norm(), 6000, 1e-6);
  EXPECT_NEAR((corners[2] - corners[1]).norm(), 6200, 1e-6);
}

TEST(PlaceOnSail, StickersLieInsideAndApartOnRandomSails) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> part(0, 1);
  int num_placed = 0;
  for (int i = 0; i < 200; ++i) {
    const double luff = 4 + 10 * part(random), foot = 1.5 + 4 * part(random);
    SailPlacementOptions options =
        Sail(luff, foot, std::hypot(luff, foot) * (0.85 + 0.25 * part(random)));
    options.num_lines = 1 + i % 9;
    options.markers_per_line = 1 + i % 14;
    Placement placement;
    try {
      placement = PlaceOnSail(options, kLength_mm, kSticker_mm, 10);
    } catch (const InputError&) {
      continue;
    }
    ++num_placed;
    std::vector<Eigen::Vector2d> centers;
    int next_id = 10;
    for (const PlacedLine& line : placement.horizontal) {
      EXPECT_GE(line.markers.size(),
                static_cast<std::size_t>(std::min(options.markers_per_line, 4)));
      const Eigen::Vector2d start(0, line.luff_mm);
      for (const MarkerPlace& marker : line.markers) {
        EXPECT_EQ(marker.marker_id, next_id++);
        EXPECT_NEAR((marker.center_mm - start).norm(), marker.along_mm, 1e-6);
        EXPECT_GE(DistanceToEdge(placement.sail_mm, marker.center_mm), kSticker_mm / std::sqrt(2));
        for (const Eigen::Vector2d& other : centers) {
          EXPECT_GE((other - marker.center_mm).norm(), kSticker_mm);
        }
        centers.push_back(marker.center_mm);
      }
    }
  }
  EXPECT_GT(num_placed, 100);
}

TEST(PlaceOnSail, VerticalLinesAreStraightAndEndAtTheEdges) {
  const Placement placement = PlaceOnSail(Sail(6, 3, 6.2), kLength_mm, kSticker_mm, 0);
  std::map<int, Eigen::Vector2d> centers;
  for (const PlacedLine& line : placement.horizontal) {
    for (const MarkerPlace& marker : line.markers) centers[marker.marker_id] = marker.center_mm;
  }
  ASSERT_GE(placement.vertical.size(), 2u);
  EXPECT_EQ(placement.vertical.front().marker_ids.size(), placement.horizontal.size());
  EXPECT_EQ(placement.vertical.back().marker_ids.size(), placement.horizontal.size());
  for (const MarkerLine& line : placement.vertical) {
    ASSERT_GE(line.marker_ids.size(), 2u);
    const Eigen::Vector2d first = centers.at(line.marker_ids.front());
    const Eigen::Vector2d along = (centers.at(line.marker_ids.back()) - first).normalized();
    double last = -1;
    for (const int id : line.marker_ids) {
      const Eigen::Vector2d offset = centers.at(id) - first;
      EXPECT_NEAR(Cross(along, offset), 0, 1e-6) << line.name;
      EXPECT_GT(along.dot(offset), last) << line.name;
      last = along.dot(offset);
    }
  }
}

TEST(PlaceOnSail, ItsLayoutNamesTheEdgesOfTheSail) {
  SailPlacementOptions options = Sail(6, 3, 6.2);
  const Placement placement = PlaceOnSail(options, kLength_mm, kSticker_mm, 0);
  const ClothEdges edges = PartOfPlacement(placement).edges;
  ASSERT_EQ(edges.luff.offsets_m.size(), 1u);
  ASSERT_EQ(edges.leech.offsets_m.size(), 1u);
  const auto& corners = placement.sail_mm;  // tack, clew, head
  const Eigen::Vector2d foot = (corners[1] - corners[0]).normalized();
  for (const PlacedLine& line : placement.horizontal) {
    const Eigen::Vector2d luff =
        line.markers.front().center_mm - 1000 * edges.luff.offsets_m[0] * foot;
    const Eigen::Vector2d leech =
        line.markers.back().center_mm + 1000 * edges.leech.offsets_m[0] * foot;
    EXPECT_NEAR(luff.x(), 0, 1);
    EXPECT_NEAR(DistanceToEdge(corners, leech), 0, 1);
  }
  const double across = std::abs(Cross(foot, (corners[2] - corners[0]).normalized()));
  EXPECT_NEAR(1000 * edges.foot.offsets_m[0], across * placement.horizontal.front().luff_mm, 0.5);
  // At the head the sail is a sticker wide.
  const double head_mm =
      placement.horizontal.back().luff_mm + 1000 * edges.head.offsets_m[0] / across;
  EXPECT_NEAR(3000 * (1 - head_mm / 6000), kSticker_mm, 1);
  // Lines of one marker in their middle.
  options.markers_per_line = 1;
  EXPECT_EQ(PlaceOnSail(options, kLength_mm, kSticker_mm, 0).edges.luff.offsets_m.size(),
            static_cast<std::size_t>(options.num_lines));
}

TEST(PlaceOnSail, BadLengthsNameTheOption) {
  ExpectThrows<InputError>([] { PlaceOnSail(SailPlacementOptions(), kLength_mm, kSticker_mm, 0); },
                           {"--Sail.luff", "missing"});
  ExpectThrows<InputError>([] { PlaceOnSail(Sail(6, 3, 10), kLength_mm, kSticker_mm, 0); },
                           {"--Sail.leech", "not a triangle"});
  ExpectThrows<InputError>([] { PlaceOnSail(Sail(9, 3, 5), kLength_mm, kSticker_mm, 0); },
                           {"--Sail.leech", "not a triangle"});
  ExpectThrows<InputError>([] { PlaceOnSail(Sail(1, 0.5, 1.1), kLength_mm, kSticker_mm, 0); },
                           {"--Sail.lines", "no room", "--marker_length"});
  SailPlacementOptions many = Sail(6, 3, 6.2);
  many.num_lines = 60;
  ExpectThrows<InputError>([&] { PlaceOnSail(many, kLength_mm, kSticker_mm, 0); },
                           {"--Sail.lines", "60 lines"});
}

TEST(PlaceOnGrid, RowsFromBelowAndColumnsFromTheLeft) {
  GridPlacementOptions options;
  options.num_rows = 2;
  options.num_columns = 3;
  options.spacing_m = 0.25;
  const Placement placement = PlaceOnGrid(options, kLength_mm, kSticker_mm, 5);
  ASSERT_EQ(placement.horizontal.size(), 2u);
  EXPECT_EQ(placement.horizontal[1].markers[2].marker_id, 10);
  EXPECT_EQ(placement.horizontal[1].markers[2].center_mm, Eigen::Vector2d(500, 250));
  EXPECT_EQ(placement.horizontal[1].markers[2].along_mm, 500);
  const LayoutPart part = PartOfPlacement(placement);
  EXPECT_EQ(part.horizontal[0].marker_ids, (std::vector<int>{5, 6, 7}));
  ASSERT_EQ(part.vertical.size(), 3u);
  EXPECT_EQ(part.vertical[1].marker_ids, (std::vector<int>{6, 9}));
  options.spacing_m = 0.1;
  ExpectThrows<InputError>([&] { PlaceOnGrid(options, kLength_mm, kSticker_mm, 0); },
                           {"--Grid.spacing", "overlap", "0.158 m"});
}

}  // namespace
}  // namespace velamap
