#include "importer/track/line_expectation.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace velamap {
namespace {

MarkerQuad Square(int marker_id, double x_px, double y_px, double side_px) {
  return {marker_id,
          {Eigen::Vector2d(x_px, y_px), Eigen::Vector2d(x_px + side_px, y_px),
           Eigen::Vector2d(x_px + side_px, y_px + side_px), Eigen::Vector2d(x_px, y_px + side_px)}};
}

TEST(ExpectOnLines, BetweenNeighborsAndBeyondTheLast) {
  const std::vector<MarkerQuad> found = {Square(1, 100, 50, 20), Square(3, 300, 70, 24)};
  const std::vector<ExpectedMarker> between = ExpectOnLines({{1, 2, 3}}, found);
  ASSERT_EQ(between.size(), 1u);
  EXPECT_EQ(between[0].quad.marker_id, 2);
  EXPECT_EQ(between[0].quad.corners_px[0], Eigen::Vector2d(200, 60));
  EXPECT_EQ(between[0].quad.corners_px[2], Eigen::Vector2d(222, 82));
  EXPECT_GT(between[0].reach_px, 5.0);
  EXPECT_LT(between[0].reach_px, 50.0);

  for (const std::vector<int>& line : {std::vector<int>{1, 3, 4}, std::vector<int>{4, 3, 1}}) {
    const std::vector<ExpectedMarker> beyond = ExpectOnLines({line}, found);
    ASSERT_EQ(beyond.size(), 1u);
    EXPECT_EQ(beyond[0].quad.marker_id, 4);
    EXPECT_EQ(beyond[0].quad.corners_px[0], Eigen::Vector2d(500, 90));
  }
}

TEST(ExpectOnLines, NothingWhereLinesDoNotTell) {
  const std::vector<MarkerQuad> found = {Square(1, 100, 50, 20), Square(3, 300, 70, 20)};
  EXPECT_TRUE(ExpectOnLines({}, found).empty());
  EXPECT_TRUE(ExpectOnLines({{1, 3}}, found).empty());           // none is missing
  EXPECT_TRUE(ExpectOnLines({{1, 2, 5, 6, 3}}, found).empty());  // too far from both

  std::vector<MarkerQuad> twice = found;
  twice.push_back(Square(3, 800, 70, 20));
  EXPECT_TRUE(ExpectOnLines({{1, 2, 3}}, twice).empty());

  const std::vector<MarkerQuad> shrinking = {Square(1, 100, 50, 40), Square(3, 300, 50, 20)};
  EXPECT_TRUE(ExpectOnLines({{1, 3, 4}}, shrinking).empty());  // it would have no size

  std::vector<MarkerQuad> turned = found;
  std::rotate(turned[1].corners_px.begin(), turned[1].corners_px.begin() + 1,
              turned[1].corners_px.end());
  EXPECT_TRUE(ExpectOnLines({{1, 2, 3}}, turned).empty());
}

TEST(ExpectOnLines, EachMarkerOnce) {
  const std::vector<MarkerQuad> found = {Square(1, 100, 50, 20), Square(3, 300, 50, 20),
                                         Square(11, 200, 0, 20), Square(13, 200, 100, 20)};
  EXPECT_EQ(ExpectOnLines({{1, 2, 3}, {11, 2, 13}}, found).size(), 1u);
}

TEST(LinesOfLayout, AreTheHorizontalAndTheVerticalOnesAndTheOthersOfAPart) {
  Layout layout;
  layout.parts.push_back({"main", false, {{"h1", {1, 2}}}, {{"v1", {1, 4}}}, {9}});
  EXPECT_EQ(LinesOfLayout(layout), (std::vector<std::vector<int>>{{1, 2}, {1, 4}, {9}}));
}

}  // namespace
}  // namespace velamap
