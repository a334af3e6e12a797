#include "tests/support/surface_renderer.h"

#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "importer/refine/marker_detector.h"

namespace velamap {
namespace {

ClipOptions BoardOptions() {
  ClipOptions options;
  options.kind = ClipKind::kBoard;
  options.wide_angle = false;
  options.width_px = 1280;
  options.distance_m = 0.6;
  options.num_frames = 60;
  return options;
}

SurfaceRenderOptions Noiseless() {
  SurfaceRenderOptions options;
  options.noise = 0;
  return options;
}

struct CornerErrors {
  int num_markers = 0;
  Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();
  double outwards_px = 0.0;  // mean along the marker's diagonals, away from its centre
  double rms_px = 0.0;
};

CornerErrors DetectAndCompare(const ClipScene& scene, const std::vector<int>& frames) {
  CornerErrors errors;
  int num_corners = 0;
  double sum_squares = 0;
  for (const int frame_idx : frames) {
    cv::Mat gray;
    cv::cvtColor(RenderClipFrame(scene, Noiseless(), frame_idx), gray, cv::COLOR_BGR2GRAY);
    std::map<int, std::array<Eigen::Vector2d, kNumCorners>> found;
    for (const MarkerDetection& marker : DetectMarkers(gray, scene.dictionary, 1, {})) {
      found[marker.marker_id] = marker.corners_in_image_px;
    }
    for (const ClipMarker& marker : scene.markers) {
      const auto truth = ProjectCorners(scene, marker, frame_idx);
      const auto it = found.find(marker.marker_id);
      if (!truth || it == found.end()) continue;
      ++errors.num_markers;
      const Eigen::Vector2d middle = 0.25 * ((*truth)[0] + (*truth)[1] + (*truth)[2] + (*truth)[3]);
      for (std::size_t i = 0; i < kNumCorners; ++i) {
        const Eigen::Vector2d error = it->second[i] - (*truth)[i];
        errors.mean_px += error;
        errors.outwards_px += error.dot(((*truth)[i] - middle).normalized());
        sum_squares += error.squaredNorm();
        ++num_corners;
      }
    }
  }
  errors.mean_px /= num_corners;
  errors.outwards_px /= num_corners;
  errors.rms_px = std::sqrt(sum_squares / num_corners);
  return errors;
}

// The corner convention of the whole chain: renderer, detector and camera agree where a corner is.
TEST(SurfaceRendererTest, DetectedCornersAreUnbiased) {
  const ClipScene scene = MakeClipScene(BoardOptions());
  const CornerErrors errors = DetectAndCompare(scene, {3, 31, 55});
  EXPECT_EQ(errors.num_markers, 36);
  EXPECT_LT(errors.mean_px.norm(), 0.02);
  EXPECT_LT(std::abs(errors.outwards_px), 0.02);
  EXPECT_LT(errors.rms_px, 0.05);
  RecordProperty("mean_px", std::to_string(errors.mean_px.norm()));
  RecordProperty("outwards_px", std::to_string(errors.outwards_px));
  RecordProperty("rms_px", std::to_string(errors.rms_px));
}

TEST(SurfaceRendererTest, MarkersOnTheSailAreWhereTheTruthIs) {
  ClipOptions options;
  options.num_frames = 1;
  options.distance_m = 5;
  const CornerErrors errors = DetectAndCompare(MakeClipScene(options), {0});
  EXPECT_GT(errors.num_markers, 90);
  EXPECT_LT(errors.mean_px.norm(), 0.03);
  EXPECT_LT(std::abs(errors.outwards_px), 0.05);
}

TEST(SurfaceRendererTest, SameArgumentsSameBytes) {
  ClipOptions options;
  options.width_px = 640;
  options.num_frames = 3;
  options.busy = true;
  SurfaceRenderOptions render;
  render.num_reflections = 2;
  render.motion_blur_px = 3;
  const ClipScene scene = MakeClipScene(options);
  const cv::Mat first = RenderClipFrame(scene, render, 1);
  EXPECT_EQ(cv::norm(first, RenderClipFrame(scene, render, 1), cv::NORM_L1), 0);
  ClipScene other = scene;
  other.options.seed = 2;
  EXPECT_GT(cv::norm(first, RenderClipFrame(other, render, 1), cv::NORM_L1), 0);
}

TEST(SurfaceRendererTest, MotionBlurLeavesThePictureInPlace) {
  ClipOptions options = BoardOptions();
  const ClipScene scene = MakeClipScene(options);
  SurfaceRenderOptions render = Noiseless();
  render.blur_px = 0;
  const cv::Mat sharp = RenderClipFrame(scene, render, 5);
  render.motion_blur_px = 6;
  const cv::Mat blurred = RenderClipFrame(scene, render, 5);
  const auto centroid = [](const cv::Mat& picture) -> Eigen::Vector2d {
    cv::Mat gray;
    cv::cvtColor(picture, gray, cv::COLOR_BGR2GRAY);
    const cv::Moments moments = cv::moments(gray);
    return Eigen::Vector2d(moments.m10, moments.m01) / moments.m00;
  };
  EXPECT_GT(cv::norm(sharp, blurred, cv::NORM_INF), 50);
  EXPECT_LT((centroid(sharp) - centroid(blurred)).norm(), 0.02);
}

TEST(SurfaceRendererTest, ReflectionsWipeOutMarkers) {
  ClipOptions options;
  options.num_frames = 1;
  const ClipScene scene = MakeClipScene(options);
  const auto count = [&](int num_reflections) {
    SurfaceRenderOptions render;
    render.num_reflections = num_reflections;
    cv::Mat gray;
    cv::cvtColor(RenderClipFrame(scene, render, 0), gray, cv::COLOR_BGR2GRAY);
    return DetectMarkers(gray, scene.dictionary, 1, {}).size();
  };
  EXPECT_LT(count(3) + 8, count(0));
}

}  // namespace
}  // namespace velamap
