#include "tests/support/render/picture_effects.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Core>

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

struct Moments {
  double sum = 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero(), variance = Eigen::Vector2d::Zero();  // px
};

Moments MomentsOf(const cv::Mat& image) {
  Moments moments;
  const auto add = [&image](const auto& by_pixel) {
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        by_pixel(image.at<float>(y, x), Eigen::Vector2d(x + 0.5, y + 0.5));
      }
    }
  };
  add([&](double light, const Eigen::Vector2d& x) {
    moments.sum += light;
    moments.mean += light * x;
  });
  moments.mean /= moments.sum;
  add([&](double light, const Eigen::Vector2d& x) {
    moments.variance += light / moments.sum * (x - moments.mean).cwiseAbs2();
  });
  return moments;
}

// Of a pixel that alone is lit.
TEST(PictureEffects, SpreadLightByTheirSizeAndLoseNone) {
  constexpr double kArea = 255.0 * kFinePerSensorPx * kFinePerSensorPx;
  constexpr double kPixelVariance = 1.0 / 12;  // of an even square of one pixel
  cv::Mat lit(40 * kFinePerSensorPx, 40 * kFinePerSensorPx, CV_32F, cv::Scalar(0));
  lit(cv::Rect(20 * kFinePerSensorPx, 20 * kFinePerSensorPx, kFinePerSensorPx, kFinePerSensorPx))
      .setTo(255);
  const auto expect = [&](const cv::Mat& image, double variance_px2, double px_by_sensor_px) {
    const Moments moments = MomentsOf(image);
    const double area =
        kArea * px_by_sensor_px * px_by_sensor_px / (kFinePerSensorPx * kFinePerSensorPx);
    EXPECT_NEAR(moments.sum, area, 1e-4 * area);
    EXPECT_LT((moments.mean / px_by_sensor_px - Eigen::Vector2d(20.5, 20.5)).norm(), 1e-4);
    const Eigen::Vector2d variances = moments.variance / (px_by_sensor_px * px_by_sensor_px);
    for (const double variance : variances) {
      EXPECT_NEAR(variance, variance_px2, 0.02 * variance_px2 + 0.02);
    }
  };
  for (const double radius_px : {0.5, 1.0, 1.7}) {
    cv::Mat fine = lit.clone();
    DefocusBlur(radius_px, &fine);
    expect(fine, 0.25 * radius_px * radius_px + kPixelVariance, kFinePerSensorPx);
  }
  for (const double share : {0.05, 0.2}) {
    cv::Mat image = OnSensor(lit);
    Halo(share, 3.0, &image);
    expect(image, share * 9.0, 1.0);
  }
}

}  // namespace
}  // namespace velamap
