#include "importer/frame_detector.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

// The part is rigid, so that all of its markers are neighbours whatever its line.
std::string Describe(SearchMode search, const std::vector<int>& line) {
  Layout layout = MakeLayout("DICT_4X4_50", 0.1);
  layout.parts.push_back({"board", true, {{"h1", line}}, {}, {}});
  ArucoDetectionOptions options;
  options.search = search;
  return DescribeDetector(MakeFrameDetector(layout, options));
}

TEST(DescribeDetector, NamesTheLinesThatATrackedSearchFollows) {
  const SearchMode tracked = SearchMode::kTracked, exhaustive = SearchMode::kExhaustive;
  EXPECT_EQ(Describe(tracked, {1, 2, 3}), Describe(tracked, {1, 2, 3}));
  EXPECT_NE(Describe(tracked, {1, 2, 3}), Describe(tracked, {2, 1, 3}));
  EXPECT_EQ(Describe(exhaustive, {1, 2, 3}), Describe(exhaustive, {2, 1, 3}));
}

TEST(LocateInFrame, AnIdBeyondTheDictionaryIsNowhere) {
  const FrameDetector detector = MakeFrameDetector(MakeLayout("DICT_4X4_50", 0.1), {});
  const cv::Mat gray(100, 100, CV_8UC1, cv::Scalar(255));
  const QuadCorners quad = {Eigen::Vector2d(30, 30), Eigen::Vector2d(60, 30),
                            Eigen::Vector2d(60, 60), Eigen::Vector2d(30, 60)};
  for (const int marker_id : {-1, 50, 1000}) {
    EXPECT_FALSE(LocateInFrame(detector, gray, marker_id, quad, 5));
  }
}

}  // namespace
}  // namespace velamap
