#include "importer/refine/edge_sampling.h"

#include <gtest/gtest.h>

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

TEST(RefineCornersBySides, AMarkerNoLargerThanItsBlurIsNone) {
  EXPECT_FALSE(RefineCornersBySides(DarkSquare(10, 2), Square(9.5, 2.0), 5));
}

}  // namespace
}  // namespace velamap
