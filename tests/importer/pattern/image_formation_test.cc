#include "importer/pattern/image_formation.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace velamap {
namespace {

TEST(ToneCurve, DecodesWhatItEncodes) {
  for (const bool is_inverted : {false, true}) {
    for (const double gamma : {0.8, 1.0, 1.8, 2.4}) {
      for (const double s_amplitude : {0.0, 0.06}) {
        ImageFormationParameters parameters;
        parameters.gamma = gamma;
        parameters.s_amplitude = s_amplitude;
        parameters.is_inverted = is_inverted;
        const ToneCurve tone(parameters);
        for (double light = 5; light < 250; light += 7) {
          EXPECT_NEAR(tone.Decode(tone.Encode(light)), light, 0.2) << gamma << " " << s_amplitude;
        }
        // Matrices are decoded through a table. Filters leave values beyond the recorded ones.
        for (double gray = -20; gray < 280; gray += 0.73) {
          cv::Mat values(1, 1, CV_32F, cv::Scalar(gray));
          tone.Decode(&values);
          EXPECT_NEAR(values.at<float>(0), tone.Decode(gray), 0.01) << gamma << " " << s_amplitude;
        }
      }
    }
  }
}

TEST(CutPatch, TellsTheLightBeforeTheHalo) {
  ImageFormationParameters parameters;
  parameters.gamma = 2.0;
  parameters.halo = 0.1;
  const ImageFormation formation(parameters);
  constexpr int kSize = 60, kSquare = 7;
  cv::Mat light(kSize, kSize, CV_32F), gray;
  light.forEach<float>([](float& value, const int* place) {
    value = (place[0] / kSquare + place[1] / kSquare) % 2 == 0 ? 10.0f : 160.0f;
  });
  cv::GaussianBlur(light, light, {0, 0}, 0.8);
  cv::GaussianBlur(light, gray, {0, 0}, parameters.halo_radius_px);
  gray = (1 - parameters.halo) * light + parameters.halo * gray;
  gray.forEach<float>([&](float& value, const int*) {
    value = static_cast<float>(formation.tone().Encode(static_cast<double>(value)));
  });
  const GrayPatch patch = CutPatch(gray, cv::Rect(18, 16, 26, 25), formation);
  for (int y = 16; y < 41; ++y) {
    for (int x = 18; x < 44; ++x) {
      const double found = LightAt(patch, formation, {x, y});
      EXPECT_NEAR(found, light.at<float>(y, x), 0.5) << x << " " << y;
    }
  }
}

TEST(CutPatch, UndoesTheSharpening) {
  const ImageFormation formation({1.0, 0.0, 0.5, 1.2});
  cv::Mat values(60, 60, CV_32F, cv::Scalar(60));
  cv::rectangle(values, {20, 18, 21, 17}, cv::Scalar(150), cv::FILLED);
  cv::GaussianBlur(values, values, {0, 0}, 0.8);
  cv::Mat blurred, gray;
  cv::GaussianBlur(values, blurred, {0, 0}, 1.2);
  cv::Mat(1.5 * values - 0.5 * blurred).convertTo(gray, CV_8U);
  const cv::Rect box(10, 10, 40, 40);
  const GrayPatch patch = CutPatch(gray, box, formation);
  EXPECT_LT(cv::norm(patch.values, values(box), cv::NORM_INF), 1.0);
}

}  // namespace
}  // namespace velamap
