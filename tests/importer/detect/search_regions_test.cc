#include "importer/detect/search_regions.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(MergeRegions, CoversTheSameAndCostsNoMore) {
  const std::vector<cv::Rect> regions = {{0, 0, 100, 100},
                                         {50, 0, 100, 100},
                                         {0, 800, 100, 100},
                                         {500, 500, 30, 30},
                                         {535, 500, 30, 30}};
  const std::vector<cv::Rect> merged = MergeRegions(regions);
  EXPECT_EQ(merged.size(), 3u);
  const auto cost_px = [](const std::vector<cv::Rect>& searched) {
    return TotalAreaPx(searched) + kCallCostPx * static_cast<double>(searched.size());
  };
  EXPECT_LE(cost_px(merged), cost_px(regions));
  for (const cv::Rect& region : regions) {
    EXPECT_TRUE(std::any_of(merged.begin(), merged.end(),
                            [&](const cv::Rect& rect) { return (rect & region) == region; }));
  }
}

}  // namespace
}  // namespace velamap
