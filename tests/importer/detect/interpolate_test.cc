#include "importer/detect/interpolate.h"

#include <limits>

#include <gtest/gtest.h>

namespace velamap {
namespace {

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
