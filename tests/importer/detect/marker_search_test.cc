#include "importer/detect/marker_search.h"

#include <gtest/gtest.h>

#include "tests/importer/marker_builders.h"

namespace velamap {
namespace {

const std::vector<DrawnMarker> kSearched = {
    {3, 40, 50, 96}, {7, 200, 60, 60}, {11, 320, 41, 24}, {49, 60, 220, 144}};

class SearchMarkersTest : public testing::Test {
 protected:
  SearchMarkersTest() {
    cv::cvtColor(DrawMarkers(dictionary_.aruco, {480, 400}, kSearched), gray_, cv::COLOR_BGR2GRAY);
    cv::GaussianBlur(gray_, gray_, cv::Size(), 0.7);
  }

  std::vector<MarkerQuad> Search(const std::vector<cv::Rect>& regions) const {
    return SearchMarkers(gray_, dictionary_, 1, {}, regions);
  }

  Dictionary dictionary_ = LoadDictionary("DICT_4X4_50");
  cv::Mat gray_;
};

TEST_F(SearchMarkersTest, ARegionGivesTheSameCornersAsTheWhole) {
  const std::vector<MarkerQuad> all = SearchMarkers(gray_, dictionary_, 1, {});
  ASSERT_EQ(all.size(), kSearched.size());
  for (const MarkerQuad& whole : all) {
    const cv::Rect square(static_cast<int>(whole.corners_px[0].x()),
                          static_cast<int>(whole.corners_px[0].y()),
                          static_cast<int>(QuadMeanSide(whole.corners_px)) + 1,
                          static_cast<int>(QuadMeanSide(whole.corners_px)) + 1);
    // Down to 4 px, less than what the threshold sees around a corner.
    for (int reach_px = 4; reach_px < 20; ++reach_px) {
      const std::vector<MarkerQuad> found =
          Search({cv::Rect(square.x - reach_px, square.y - reach_px, square.width + 2 * reach_px,
                           square.height + 2 * reach_px)});
      ASSERT_EQ(found.size(), 1u) << whole.marker_id << " " << reach_px;
      EXPECT_EQ(found[0].marker_id, whole.marker_id);
      EXPECT_EQ(found[0].corners_px, whole.corners_px) << whole.marker_id << " " << reach_px;
    }
  }
}

TEST_F(SearchMarkersTest, OnlyRegionsAreSearchedAndWhatTheyShareComesOnce) {
  EXPECT_TRUE(Search({}).empty());
  EXPECT_TRUE(Search({{0, 0, 100, 400}}).empty());  // cuts through every marker that it touches
  const std::vector<MarkerQuad> found = Search({{20, 30, 160, 150}, {25, 20, 300, 170}});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].marker_id, 3);
  EXPECT_EQ(found[1].marker_id, 7);
}

TEST_F(SearchMarkersTest, TheSmallestPerimeterIsThatOfTheWholeImage) {
  ArucoDetectionOptions options;
  options.min_marker_perimeter_rate = 0.25;  // 120 px: the 24 px marker is too small
  EXPECT_EQ(SearchMarkers(gray_, dictionary_, 1, options).size(), 3u);
  EXPECT_TRUE(SearchMarkers(gray_, dictionary_, 1, options, {{300, 21, 64, 64}}).empty());
  EXPECT_EQ(SearchMarkers(gray_, dictionary_, 1, {}, {{300, 21, 64, 64}}).size(), 1u);
}

}  // namespace
}  // namespace velamap
