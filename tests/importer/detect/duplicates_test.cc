#include "importer/detect/duplicates.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "tests/importer/marker_builders.h"

namespace velamap {
namespace {

// A line 1 - 2 - 3 - 4 - 5, and 90 on no line.
AdjacencyGraph LineGraph() {
  Layout layout;
  LayoutPart part;
  part.name = "sail";
  part.horizontal = {{"h1", {1, 2, 3, 4, 5}}};
  part.marker_ids = {90};
  layout.parts = {part};
  return BuildAdjacencyGraph(layout);
}

std::vector<int> Ids(const std::vector<MarkerDetection>& markers) {
  std::vector<int> ids;
  for (const MarkerDetection& marker : markers) ids.push_back(marker.marker_id);
  return ids;
}

TEST(ResolveDuplicates, KeepsTheCandidateNearItsNeighborsWhateverTheOrder) {
  const std::vector<MarkerDetection> ordered = {
      SquareMarker(1, 100, 100), SquareMarker(2, 200, 100), SquareMarker(3, 300, 100),
      SquareMarker(3, 900, 700), SquareMarker(4, 400, 100), SquareMarker(5, 500, 100)};
  std::mt19937 random(3);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<MarkerDetection> shuffled = ordered;
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    const ResolvedDetections resolved = ResolveDuplicates(shuffled, LineGraph());
    EXPECT_EQ(Ids(resolved.markers), (std::vector<int>{1, 2, 3, 4, 5}));
    EXPECT_EQ(CornerMean(resolved.markers[2]), Eigen::Vector2d(300, 100));
    ASSERT_EQ(resolved.rejected.size(), 1u);
    EXPECT_EQ(CornerMean(resolved.rejected[0].detection), Eigen::Vector2d(900, 700));
    EXPECT_EQ(resolved.rejected[0].reason, "duplicated id, further from its neighbours");
  }
}

TEST(ResolveDuplicates, OnlyTheThreeTopologicallyNearestCount) {
  // Markers 2, 3 and 4 draw marker 1 to the left; 5, the fourth, would draw it far to the right.
  const ResolvedDetections resolved = ResolveDuplicates(
      {SquareMarker(1, 100, 100), SquareMarker(1, 3000, 100), SquareMarker(2, 200, 100),
       SquareMarker(3, 300, 100), SquareMarker(4, 400, 100), SquareMarker(5, 90000, 100)},
      LineGraph());
  EXPECT_EQ(CornerMean(resolved.markers[0]), Eigen::Vector2d(100, 100));
}

TEST(ResolveDuplicates, DuplicatedNeighborsAreNoWitnesses) {
  // 2 is there twice, so 1 is judged by 3 alone and 2 by 3 alone.
  const ResolvedDetections resolved = ResolveDuplicates(
      {SquareMarker(1, 250, 100), SquareMarker(1, 700, 100), SquareMarker(2, 320, 100),
       SquareMarker(2, 710, 100), SquareMarker(3, 300, 100)},
      LineGraph());
  ASSERT_EQ(Ids(resolved.markers), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(CornerMean(resolved.markers[0]).x(), 250);
  EXPECT_EQ(CornerMean(resolved.markers[1]).x(), 320);
}

TEST(ResolveDuplicates, WithoutNeighborsAllCandidatesAreLeftOut) {
  for (const int id : {90, 77}) {  // on no line; not in the graph
    const ResolvedDetections resolved = ResolveDuplicates(
        {SquareMarker(id, 100, 100), SquareMarker(1, 50, 50), SquareMarker(id, 500, 100)},
        LineGraph());
    EXPECT_EQ(Ids(resolved.markers), std::vector<int>{1});
    ASSERT_EQ(resolved.rejected.size(), 2u);
    EXPECT_EQ(resolved.rejected[0].reason, "duplicated id, no neighbour tells which is right");
    EXPECT_LT(CornerMean(resolved.rejected[0].detection).x(),
              CornerMean(resolved.rejected[1].detection).x());
  }
  EXPECT_EQ(ResolveDuplicates({SquareMarker(5, 1, 1), SquareMarker(5, 9, 9)}, {}).rejected.size(),
            2u);
}

TEST(ResolveDuplicates, UniqueMarkersPassUntouched) {
  const ResolvedDetections resolved =
      ResolveDuplicates({SquareMarker(7, 1, 1), SquareMarker(0, 5, 5)}, {});
  EXPECT_EQ(Ids(resolved.markers), (std::vector<int>{0, 7}));
  EXPECT_TRUE(resolved.rejected.empty());
}

}  // namespace
}  // namespace velamap
