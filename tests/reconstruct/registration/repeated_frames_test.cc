#include "reconstruct/registration/repeated_frames.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace velamap {
namespace {

// A clip whose markers have moved together by `shifts_px`, with the noise of their corners.
double ShareOfRepeated(const std::vector<double>& shifts_px, std::mt19937* random,
                       double noise = 0.01, double sigma_px = 0.0) {
  std::normal_distribution<double> noise_px(0.0, noise);
  std::vector<DatabaseImage> clip(shifts_px.size());
  std::vector<const DatabaseImage*> frames;
  for (std::size_t i = 0; i < clip.size(); ++i) {
    for (int id = 0; id < 6; ++id) {
      MarkerDetection marker;
      marker.marker_id = id;
      for (Eigen::Vector2d& x_px : marker.corners_in_image_px) {
        x_px = Eigen::Vector2d(shifts_px[i] + noise_px(*random), noise_px(*random));
      }
      marker.corner_sigma_px.fill(sigma_px);
      clip[i].detections.markers.push_back(marker);
    }
    frames.push_back(&clip[i]);
  }
  const std::vector<bool> is_repeated = FindRepeatedFrames(frames);
  const auto num_repeated = std::count(is_repeated.begin(), is_repeated.end(), true);
  return static_cast<double>(num_repeated) / static_cast<double>(clip.size());
}

TEST(FindRepeatedFrames, FindsAllOfASteadilyMovingClip) {
  std::mt19937 random(7);
  for (const int num_shown : {1, 2, 3}) {  // each picture, in a row
    std::vector<double> shifts_px;
    for (int i = 0; i < 60; ++i) shifts_px.push_back(2.0 * (i / num_shown));
    EXPECT_NEAR(ShareOfRepeated(shifts_px, &random), 1.0 - 1.0 / num_shown, 1e-9);
  }
}

TEST(FindRepeatedFrames, ACameraAtRestRepeatsNone) {
  std::mt19937 random(8);
  EXPECT_EQ(ShareOfRepeated(std::vector<double>(200, 0.0), &random), 0.0);
}

// One picture again and again, as the compression of a video leaves it.
TEST(FindRepeatedFrames, AVideoAtRestRepeatsAllFrames) {
  std::mt19937 random(10);
  const std::vector<double> still(100, 0.0);
  constexpr double kSigmaPx = 0.05;
  EXPECT_NEAR(ShareOfRepeated(still, &random, 0.004, kSigmaPx), 0.99, 1e-9);
  EXPECT_EQ(ShareOfRepeated(still, &random, kSigmaPx, kSigmaPx), 0.0);
}

// All markers turn back at the same time: the worst case, because a frame on either side of that
// time may show the same picture.
TEST(FindRepeatedFrames, AShakingCameraRepeatsFew) {
  constexpr int kNumDraws = 20;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> phase_rad(0, 6.28), frequency_rad_s(6, 30);
  double sum = 0.0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    const double phase = phase_rad(random), frequency = frequency_rad_s(random);
    std::vector<double> shifts_px;
    for (int i = 0; i < 60; ++i) shifts_px.push_back(12 * std::sin(frequency * i / 60 + phase));
    sum += ShareOfRepeated(shifts_px, &random);
  }
  EXPECT_LT(sum / kNumDraws, 0.03);
}

}  // namespace
}  // namespace velamap
