#include "tests/support/render/marker_renderer.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/support/detect_markers.h"

namespace velamap {
namespace {

// A marker parallel to the image whose corners lie at the given places.
PlacedMarkerInCam Upright(double left_px, double top_px, double side_px) {
  const auto at = [](double x, double y) { return Eigen::Vector3d(x / 100, y / 100, 1); };
  return {3,
          {at(left_px, top_px), at(left_px + side_px, top_px),
           at(left_px + side_px, top_px + side_px), at(left_px, top_px + side_px)}};
}

const Camera kCamera{CameraModel::kPinhole, 80, 60, {100, 100, 0, 0}};

TEST(RenderMarkers, PixelsAreMeansOverTheirAreaInColmapsFrame) {
  RenderOptions options;
  options.blur_sigma_px = 0;
  const cv::Mat image =
      RenderMarkers(kCamera, {Upright(20.25, 12.5, 24)}, LoadDictionary("DICT_4X4_50"), 1, options);
  // The first column of the black square is covered by three quarters, the first row by half.
  EXPECT_EQ(image.at<std::uint8_t>(25, 19), 200);
  EXPECT_NEAR(image.at<std::uint8_t>(25, 20), 200 - 0.75 * 160, 1);
  EXPECT_EQ(image.at<std::uint8_t>(25, 21), 40);
  EXPECT_NEAR(image.at<std::uint8_t>(12, 30), 200 - 0.5 * 160, 1);
  EXPECT_NEAR(image.at<std::uint8_t>(36, 30), 200 - 0.5 * 160, 1);
  EXPECT_EQ(image.at<std::uint8_t>(2, 2), 120);
}

TEST(RenderMarkers, BacksAreNotDrawnAndNearMarkersHideFarOnes) {
  RenderOptions options;
  options.blur_sigma_px = 0;
  const Dictionary dictionary = LoadDictionary("DICT_4X4_50");
  PlacedMarkerInCam back = Upright(20, 12, 24);
  std::swap(back.corners_in_cam[0], back.corners_in_cam[1]);
  std::swap(back.corners_in_cam[2], back.corners_in_cam[3]);
  EXPECT_EQ(cv::countNonZero(RenderMarkers(kCamera, {back}, dictionary, 1, options) != 120), 0);

  PlacedMarkerInCam near = Upright(30, 12, 24);
  for (auto& corner : near.corners_in_cam) corner *= 0.5;
  const PlacedMarkerInCam far = Upright(20, 12, 24);
  const cv::Mat image = RenderMarkers(kCamera, {near, far}, dictionary, 1, options);
  EXPECT_EQ(cv::norm(image, RenderMarkers(kCamera, {far, near}, dictionary, 1, options)), 0);
  const cv::Mat alone = RenderMarkers(kCamera, {near}, dictionary, 1, options);
  const cv::Rect area(31, 13, 22, 22);
  EXPECT_EQ(cv::norm(image(area), alone(area)), 0);
}

TEST(RenderFrame, ShowsTheMarkersOfTheSceneWhereTheyAreAndIsRepeatable) {
  SyntheticSceneOptions scene_options;
  scene_options.num_frames = 3;
  const SyntheticScene scene = MakeSyntheticScene(scene_options);
  RenderOptions options;
  options.noise_sigma = 2;
  options.background_texture = 10;
  const cv::Mat image = RenderFrame(scene, 1, options);
  EXPECT_EQ(cv::norm(image, RenderFrame(scene, 1, options)), 0);
  ASSERT_EQ(image.size(), cv::Size(scene.camera.width_px, scene.camera.height_px));
  const auto found =
      DetectMarkers(image, LoadDictionary(scene.layout.dictionary), scene.layout.border_bits, {});
  const auto& truth = scene.frames[1].markers;
  ASSERT_EQ(found.size(), truth.size());
  for (const MarkerDetection& marker : found) {
    const auto match = std::find_if(truth.begin(), truth.end(), [&](const auto& other) {
      return other.marker_id == marker.marker_id;
    });
    ASSERT_NE(match, truth.end());
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      EXPECT_LT((marker.corners_in_image_px[i] - match->corners_in_image_px[i]).norm(), 0.2);
    }
  }
}

}  // namespace
}  // namespace velamap
