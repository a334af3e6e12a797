#include "tests/support/render/picture_effects.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

// The integral up to x of a step from 0 to 1 at zero that a Gaussian blurs.
double LightUpTo(double x, double sigma) {
  const double z = x / sigma;
  return 0.5 * x * std::erfc(-z / std::sqrt(2.0)) +
         sigma * std::exp(-0.5 * z * z) / std::sqrt(2 * kPi);
}

// Where a step lies on the pixels makes no difference.
TEST(LensBlur, ActsBeforeTheSensorSamplesTheLight) {
  constexpr int kWidth = 24;
  for (const double sigma_px : {0.4, 0.5, 0.7, 1.1}) {
    for (double edge_px = 11.0; edge_px < 12.0; edge_px += 0.125) {
      cv::Mat fine(4 * kFinePerSensorPx, kWidth * kFinePerSensorPx, CV_32F);
      for (int x = 0; x < fine.cols; ++x) {
        fine.col(x).setTo(255 * std::clamp(x + 1 - kFinePerSensorPx * edge_px, 0.0, 1.0));
      }
      LensBlur(sigma_px, &fine);
      const cv::Mat image = OnSensor(fine);
      ASSERT_EQ(image.size(), cv::Size(kWidth, 4));
      for (int x = 4; x < kWidth - 4; ++x) {
        const double expected =
            255 * (LightUpTo(x + 1 - edge_px, sigma_px) - LightUpTo(x - edge_px, sigma_px));
        EXPECT_NEAR(image.at<float>(1, x), expected, 255 * 0.025)
            << sigma_px << " px, edge at " << edge_px << ", pixel " << x;
      }
    }
  }
}

}  // namespace
}  // namespace velamap
