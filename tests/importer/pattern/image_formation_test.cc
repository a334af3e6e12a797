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
        const ToneCurve tone({gamma, s_amplitude, 0, 1, 0, 0, 0, is_inverted});
        for (double light = 5; light < 250; light += 7) {
          EXPECT_NEAR(tone.Decode(tone.Encode(light)), light, 0.2) << gamma << " " << s_amplitude;
        }
      }
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
