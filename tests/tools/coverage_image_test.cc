#include "tests/support/render/coverage_image.h"

#include <cmath>

#include <gtest/gtest.h>

namespace velamap {
namespace {

ImageQuad Rectangle(double left, double top, double right, double bottom) {
  return {{{left, top}, {right, top}, {right, bottom}, {left, bottom}}};
}

ImageQuad Turned(const ImageQuad& quad, const Eigen::Vector2d& middle, double angle_rad) {
  Eigen::Matrix2d rotation;
  rotation << std::cos(angle_rad), -std::sin(angle_rad), std::sin(angle_rad), std::cos(angle_rad);
  ImageQuad turned;
  for (std::size_t i = 0; i < quad.size(); ++i) turned[i] = middle + rotation * (quad[i] - middle);
  return turned;
}

float Gray(const cv::Mat& sums, int row, int column) { return sums.at<cv::Vec2f>(row, column)[0]; }

TEST(CoverageImageTest, PixelsGetTheirCoveredPart) {
  CoverageImage image(8, 6);
  image.Add(Rectangle(1.25, 2.5, 4.5, 4.0), 100, 0.5);
  const cv::Mat sums = image.Resolve();
  EXPECT_NEAR(Gray(sums, 2, 1), 37.5, 1e-4);
  EXPECT_NEAR(Gray(sums, 3, 1), 75, 1e-4);
  EXPECT_NEAR(Gray(sums, 3, 3), 100, 1e-4);
  EXPECT_NEAR(Gray(sums, 3, 4), 50, 1e-4);
  EXPECT_NEAR(Gray(sums, 3, 5), 0, 1e-4);
  EXPECT_NEAR(Gray(sums, 4, 2), 0, 1e-4);
  EXPECT_NEAR((sums.at<cv::Vec2f>(3, 3)[1]), 0.5, 1e-6);
}

TEST(CoverageImageTest, AreaAndCentroidAreExact) {
  for (const double angle : {0.0, 0.1, 0.7, 1.5, 2.9}) {
    CoverageImage image(40, 30);
    const Eigen::Vector2d middle(17.3, 14.8);
    image.Add(Turned(Rectangle(12.3, 10.8, 22.3, 18.8), middle, angle), 1, 0);
    const cv::Mat sums = image.Resolve();
    double area = 0;
    Eigen::Vector2d moment(0, 0);
    for (int row = 0; row < sums.rows; ++row) {
      for (int column = 0; column < sums.cols; ++column) {
        area += Gray(sums, row, column);
        moment += Gray(sums, row, column) * Eigen::Vector2d(column + 0.5, row + 0.5);
      }
    }
    EXPECT_NEAR(area, 80, 1e-3);
    // The centre of a cut pixel's cover is not the pixel's; by symmetry that cancels.
    EXPECT_LT((moment / area - middle).norm(), 0.01);
  }
}

TEST(CoverageImageTest, PiecesLeaveNoSeam) {
  CoverageImage image(20, 20);
  // A fan of quads around one point covers the inside once.
  const Eigen::Vector2d hub(9.37, 10.61);
  const ImageQuad outline = Turned(Rectangle(-5, -5, 25, 25), {10, 10}, 0.3);
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[(i + 1) % 4];
    image.Add({{hub, a, 0.4 * a + 0.6 * b, b}}, 200, 1);
  }
  const cv::Mat sums = image.Resolve();
  for (int row = 0; row < sums.rows; ++row) {
    for (int column = 0; column < sums.cols; ++column) {
      EXPECT_NEAR(Gray(sums, row, column), 200, 1e-2);
    }
  }
}

TEST(CoverageImageTest, WhatReachesBeyondTheImageIsCutOff) {
  CoverageImage image(4, 4);
  image.Add(Rectangle(-100, -100, 1.5, 100), 10, 0);
  image.Add(Rectangle(50, 0, 60, 4), 99, 0);
  image.Add(Rectangle(0, 50, 4, 60), 99, 0);
  const cv::Mat sums = image.Resolve();
  for (int row = 0; row < 4; ++row) {
    EXPECT_NEAR(Gray(sums, row, 0), 10, 1e-4);
    EXPECT_NEAR(Gray(sums, row, 1), 5, 1e-4);
    EXPECT_NEAR(Gray(sums, row, 3), 0, 1e-4);
  }
}

}  // namespace
}  // namespace velamap
