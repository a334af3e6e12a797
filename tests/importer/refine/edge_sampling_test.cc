#include "importer/refine/edge_sampling.h"

#include <limits>

#include <gtest/gtest.h>

#include "importer/detect/interpolate.h"
#include "importer/refine/corner_refinement.h"

namespace velamap {
namespace {

cv::Mat DarkSquare(int first, int side) {
  cv::Mat gray(40, 40, CV_8UC1, cv::Scalar(200));
  gray(cv::Rect(first, first, side, side)).setTo(20);
  return gray;
}

QuadCorners Square(double first, double side) {
  return {Eigen::Vector2d(first, first), Eigen::Vector2d(first + side, first),
          Eigen::Vector2d(first + side, first + side), Eigen::Vector2d(first, first + side)};
}

TEST(SampleSide, ASideNoLongerThanItsBlurHasNoSamples) {
  const cv::Mat gray = DarkSquare(10, 4);
  for (const double blur_px : {2.0, 2.5, 5.0}) {
    const SideModel model = MakeSideModel(gray, Square(9.5, 4.0), 0, 5, blur_px);
    EdgeSamples samples;
    SampleSide(gray, model, 2.0, 128, &samples);
    EXPECT_EQ(samples.count, 0) << blur_px;
  }
  EdgeSamples samples;
  SampleSide(gray, MakeSideModel(gray, Square(9.5, 4.0), 0, 5, 0.5), 2.0, 128, &samples);
  EXPECT_GT(samples.count, 0);
}

TEST(RefineCornersByEdges, AMarkerNoLargerThanItsBlurIsNone) {
  EXPECT_FALSE(RefineCornersByEdges(DarkSquare(10, 2), Square(9.5, 2.0), 5));
}

TEST(InterpolateGray, IsBilinearAndTakesTheNearestValueOutside) {
  cv::Mat gray(2, 3, CV_8UC1, cv::Scalar(0));
  gray.at<std::uint8_t>(0, 0) = 40;
  gray.at<std::uint8_t>(0, 1) = 80;
  EXPECT_DOUBLE_EQ(InterpolateGray(gray, {0.5, 0.0}), 60.0);
  EXPECT_DOUBLE_EQ(InterpolateGray(gray, {0.5, 0.5}), 30.0);
  EXPECT_DOUBLE_EQ(InterpolateGray(gray, {-1e9, -7.0}), 40.0);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(InterpolateGray(gray, {infinity, -infinity}), 0.0, 0.1);
}

// A quad without area maps its cells to places that are not numbers.
TEST(InterpolateGray, AnswersForAPlaceThatIsNotANumber) {
  cv::Mat gray(2, 2, CV_8UC1, cv::Scalar(0));
  gray.at<std::uint8_t>(0, 0) = 40;
  gray.at<std::uint8_t>(1, 0) = 90;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_DOUBLE_EQ(InterpolateGray(gray, {nan, nan}), 40.0);
  EXPECT_NEAR(InterpolateGray(gray, {nan, 1.0}), 90.0, 0.1);
}

}  // namespace
}  // namespace velamap
