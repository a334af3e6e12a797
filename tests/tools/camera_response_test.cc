#include "tests/support/clip/camera_response.h"

#include <cmath>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/render/picture_effects.h"

namespace velamap {
namespace {

CameraResponse WithCurve(ToneCurveKind kind) {
  CameraResponse response;
  response.tone_curve = kind;
  return response;
}

cv::Mat Ramp(double step) {
  cv::Mat image(40, 200, CV_32FC3);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      image.at<cv::Vec3f>(row, column) = cv::Vec3f::all(static_cast<float>(step * column));
    }
  }
  return image;
}

TEST(CameraResponseTest, BlackAndWhiteStayAndCurvesRise) {
  for (const ToneCurveKind kind : {ToneCurveKind::kLinear, ToneCurveKind::kSrgb,
                                   ToneCurveKind::kGamma, ToneCurveKind::kSCurve}) {
    CameraResponse response = WithCurve(kind);
    response.s_curve = 0.08;
    EXPECT_NEAR(EncodeLight(response, 0), 0, 1e-9);
    EXPECT_NEAR(EncodeLight(response, 255), 255, 1e-9);
    for (double light = 0.01; light < 255; light += 0.5) {
      EXPECT_LT(EncodeLight(response, light), EncodeLight(response, light + 0.5)) << light;
    }
  }
}

TEST(CameraResponseTest, CurvesAreThoseOfTheirNames) {
  // IEC 61966-2-1: both pieces, and the mid grey that prints as 118 of 255.
  const CameraResponse srgb = WithCurve(ToneCurveKind::kSrgb);
  EXPECT_NEAR(EncodeLight(srgb, 0.255), 12.92 * 0.255, 1e-9);
  EXPECT_NEAR(EncodeLight(srgb, 0.18 * 255), 117.64, 0.01);
  EXPECT_NEAR(EncodeLight(srgb, 0.0031308 * 255), EncodeLight(srgb, 0.0031309 * 255), 1e-3);
  CameraResponse gamma = WithCurve(ToneCurveKind::kGamma);
  gamma.gamma = 2;
  EXPECT_NEAR(EncodeLight(gamma, 255 * 0.25), 127.5, 1e-9);
}

TEST(CameraResponseTest, SCurveMovesGreyValuesByItsAmplitude) {
  CameraResponse response = WithCurve(ToneCurveKind::kSCurve);
  const CameraResponse srgb = WithCurve(ToneCurveKind::kSrgb);
  response.s_curve = 0.05;
  double lowest = 0, highest = 0;
  for (double light = 0; light <= 255; light += 0.05) {
    const double moved = EncodeLight(response, light) - EncodeLight(srgb, light);
    lowest = std::min(lowest, moved);
    highest = std::max(highest, moved);
  }
  EXPECT_NEAR(lowest, -0.05 * 255, 1e-3);
  EXPECT_NEAR(highest, 0.05 * 255, 1e-3);
}

TEST(CameraResponseTest, PicturesAreEncodedAsSingleLightsAre) {
  CameraResponse response = WithCurve(ToneCurveKind::kSCurve);
  cv::Mat image = Ramp(1.4);  // to 279: beyond white
  const cv::Mat light = image.clone();
  ApplyResponse(response, &image);
  for (int column = 0; column < image.cols; ++column) {
    EXPECT_NEAR(image.at<cv::Vec3f>(7, column)[1],
                EncodeLight(response, light.at<cv::Vec3f>(7, column)[1]), 0.02);
  }
}

// An unsharp mask adds amount * (picture - blurred): nothing on a ramp, and at a step what a
// Gaussian's integral says.
TEST(CameraResponseTest, SharpeningOvershootsAtAStepOnly) {
  CameraResponse response;
  response.sharpening = 0.8;
  response.sharpening_radius_px = 1.5;
  cv::Mat ramp = Ramp(1);
  ApplyResponse(response, &ramp);
  EXPECT_NEAR(ramp.at<cv::Vec3f>(20, 100)[0], 100, 1e-3);
  cv::Mat step(41, 81, CV_32FC3, cv::Scalar::all(50));
  step.colRange(40, 81).setTo(cv::Scalar::all(150));
  ApplyResponse(response, &step);
  for (const int column : {34, 38, 39, 40, 42, 44}) {
    const double from_step = column + 0.5 - 40;
    const double blurred = 100 + 50 * std::erf(from_step / 1.5 / std::sqrt(2.0));
    const double before = column < 40 ? 50 : 150;
    EXPECT_NEAR(step.at<cv::Vec3f>(20, column)[2], before + 0.8 * (before - blurred), 0.5)
        << column;
  }
}

TEST(CameraResponseTest, OptionsOutOfRangeAreNamed) {
  CameraResponse response;
  response.s_curve = 0.09;
  EXPECT_THROW(response.Check(), InputError);
  response = {};
  response.sharpening_radius_px = std::nan("");
  EXPECT_THROW(response.Check(), InputError);
}

TEST(PictureEffectsTest, ShotNoiseGrowsWithTheRootOfLight) {
  for (const double light : {20.0, 180.0}) {
    cv::Mat image(200, 200, CV_32FC3, cv::Scalar::all(light));
    AddNoise(0.5, 3.0, 7, &image);
    cv::Scalar mean, std;
    cv::meanStdDev(image, mean, std);
    EXPECT_NEAR(mean[0], light, 0.05);
    EXPECT_NEAR(std[1], std::sqrt(0.25 + 9 * light / 255), 0.03);
  }
}

}  // namespace
}  // namespace velamap
