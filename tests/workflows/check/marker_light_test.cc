#include "workflows/check/marker_light.h"

#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "workflows/check/clip_light.h"

namespace velamap {
namespace {

constexpr int kSubpixels = 8;  // samples along a side of a pixel

// A black square on white paper, seen somewhat turned, with the blur of a lens and of a motion
// along the rows. Values are area means, as a camera's.
cv::Mat Picture(const QuadCorners& corners_px, double black, double white, double blur_px,
                double motion_px) {
  cv::Mat fine(160 * kSubpixels, 160 * kSubpixels, CV_32F, cv::Scalar(white));
  std::vector<cv::Point> outline;
  for (const Eigen::Vector2d& x_px : corners_px) {
    outline.emplace_back(cvRound(kSubpixels * x_px.x() - 0.5),
                         cvRound(kSubpixels * x_px.y() - 0.5));
  }
  cv::fillConvexPoly(fine, outline, cv::Scalar(black));
  cv::GaussianBlur(fine, fine, {0, 0}, kSubpixels * blur_px);
  if (motion_px > 0) cv::blur(fine, fine, {cvRound(kSubpixels * motion_px) | 1, 1});
  cv::Mat gray;
  cv::resize(fine, gray, {160, 160}, 0, 0, cv::INTER_AREA);
  gray.convertTo(gray, CV_8U);
  return gray;
}

QuadCorners Square(double turn_rad) {
  const Eigen::Vector2d middle(80.3, 79.6), right(std::cos(turn_rad), std::sin(turn_rad));
  const Eigen::Vector2d down(-right.y(), right.x());
  return {middle - 40 * right - 40 * down, middle + 40 * right - 40 * down,
          middle + 40 * right + 40 * down, middle - 40 * right + 40 * down};
}

TEST(MarkerLight, TellsLevelsAndBlur) {
  std::mt19937 random(3);
  const auto between = [&](double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
  };
  for (int i = 0; i < 20; ++i) {
    const double black = between(10, 60), white = between(140, 240), blur_px = between(0.6, 2.0);
    const QuadCorners corners_px = Square(between(-0.6, 0.6));
    const auto light = MeasureLight(Picture(corners_px, black, white, blur_px, 0), corners_px);
    ASSERT_TRUE(light);
    EXPECT_NEAR(light->black, black, 2);
    EXPECT_NEAR(light->white, white, 2);
    // A pixel's area and the differences over a pixel widen an edge, too.
    EXPECT_NEAR(light->least_blur_px, std::hypot(blur_px, 0.45), 0.12) << blur_px;
    EXPECT_NEAR(light->most_blur_px / light->least_blur_px, 1, 0.1);
  }
}

TEST(MarkerLight, MotionIsTheBlurAcrossOneWayOnly) {
  const QuadCorners corners_px = Square(0.05);
  const auto light = MeasureLight(Picture(corners_px, 30, 220, 0.7, 6), corners_px);
  ASSERT_TRUE(light);
  const double motion_px = std::sqrt(12 * (light->most_blur_px * light->most_blur_px -
                                           light->least_blur_px * light->least_blur_px));
  EXPECT_NEAR(motion_px, 6, 2.5);
}

TEST(MarkerLight, IsUnknownAtTheBorderAndWithoutContrast) {
  QuadCorners corners_px = Square(0);
  EXPECT_FALSE(MeasureLight(Picture(corners_px, 120, 124, 0.7, 0), corners_px));
  for (Eigen::Vector2d& x_px : corners_px) x_px.x() -= 40;
  EXPECT_FALSE(MeasureLight(Picture(corners_px, 30, 220, 0.7, 0), corners_px));
}

// The clip as a whole is well exposed, but one marker glares.
TEST(MeasureLights, FindsTheMarkersInGlare) {
  const QuadCorners corners_px = Square(0.1);
  for (const bool is_inverted : {false, true}) {
    ClipFrames clip;
    std::vector<FrameDetections> detections(6);
    DetectionsByName by_name;
    for (std::size_t i = 0; i < detections.size(); ++i) {
      const double black = i % 3 == 0 ? 210 : 30, white = i % 3 == 0 ? 250 : 220;
      Frame frame;
      frame.image_name = std::to_string(i);
      frame.gray = is_inverted ? Picture(corners_px, white, black, 0.8, 0)
                               : Picture(corners_px, black, white, 0.8, 0);
      clip.frames.push_back(frame);
      MarkerDetection marker;
      marker.marker_id = static_cast<int>(i % 3);
      marker.corners_in_image_px = corners_px;
      detections[i].markers = {marker};
      by_name[frame.image_name] = &detections[i];
    }
    ClipFacts facts;
    facts.is_inverted = is_inverted;
    MeasureLights(clip, by_name, &facts);
    EXPECT_NEAR(*facts.black, 30, 2);
    EXPECT_NEAR(*facts.white, 220, 2);
    EXPECT_DOUBLE_EQ(facts.poor_light_share, 1.0 / 3);
    EXPECT_EQ(facts.ids_in_poor_light, std::vector<int>{0});
  }
}

}  // namespace
}  // namespace velamap
