#include "importer/pattern/image_formation.h"

#include <cstdint>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace velamap {
namespace {

TEST(ToneCurve, DecodesWhatItEncodes) {
  for (const bool is_inverted : {false, true}) {
    for (const double gamma : {0.8, 1.0, 1.8, 2.4}) {
      for (const double s_amplitude : {0.0, 0.06}) {
        const ToneCurve tone({gamma, s_amplitude, 0, 1, 0, 0, 0, is_inverted});
        for (double light = 5; light < 250; light += 7) {
          EXPECT_NEAR(tone.Decode(tone.Encode(light)), light, 0.2) << gamma << " " << s_amplitude;
        }
      }
    }
  }
}

TEST(CutPatch, UndoesTheSharpening) {
  for (const ImageFormationParameters& parameters :
       {ImageFormationParameters{1.0, 0.0, 0.5, 1.2},
        ImageFormationParameters{2.2, 0.0, 0.5, 1.2, 0.0, 0.0, 0.0, false, true}}) {
    const ImageFormation formation(parameters);
    cv::Mat light(60, 60, CV_32F, cv::Scalar(60));
    cv::rectangle(light, {20, 18, 21, 17}, cv::Scalar(150), cv::FILLED);
    cv::GaussianBlur(light, light, {0, 0}, 0.8);
    cv::Mat blurred;
    cv::GaussianBlur(light, blurred, {0, 0}, 1.2);
    const cv::Mat sharpened = 1.5 * light - 0.5 * blurred;
    cv::Mat gray(light.size(), CV_8U);
    for (int y = 0; y < gray.rows; ++y) {
      for (int x = 0; x < gray.cols; ++x) {
        gray.at<std::uint8_t>(y, x) =
            cv::saturate_cast<std::uint8_t>(formation.tone().Encode(sharpened.at<float>(y, x)));
      }
    }
    const GrayPatch patch = CutPatch(gray, {10, 10, 40, 40}, formation);
    for (int y = 0; y < patch.values.rows; ++y) {
      for (int x = 0; x < patch.values.cols; ++x) {
        EXPECT_NEAR(patch.values.at<float>(y, x),
                    formation.tone().Encode(light.at<float>(y + 10, x + 10)), 1.0)
            << "sharpens light: " << parameters.sharpens_light;
      }
    }
  }
}

}  // namespace
}  // namespace velamap
