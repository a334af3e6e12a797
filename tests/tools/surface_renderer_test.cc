#include "tests/support/render/surface_renderer.h"

#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "importer/base/error.h"
#include "importer/geometry/quad.h"
#include "tests/support/detect_markers.h"

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
      const Eigen::Vector2d middle = QuadCenter(*truth);
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

// Green of a picture without blur and noise, in which grey values are light.
cv::Mat LightOfBoard(const ClipOptions& options, double ink_level, double paper_level) {
  SurfaceRenderOptions render = Noiseless();
  render.blur_px = 0;
  render.ink_level = ink_level;
  render.paper_level = paper_level;
  cv::Mat green;
  cv::extractChannel(RenderClipFrame(MakeClipScene(options), render, 0), green, 1);
  return green;
}

// What a level changes in the picture is the area of what has it; in units of no importance.
double InkedArea(const ClipOptions& options) {
  return cv::sum(LightOfBoard(options, 0.45, 0.9))[0] -
         cv::sum(LightOfBoard(options, 0.05, 0.9))[0];
}

double PaperArea(const ClipOptions& options) {
  return cv::sum(LightOfBoard(options, 0.1, 0.95))[0] -
         cv::sum(LightOfBoard(options, 0.1, 0.55))[0];
}

// Dark cells of all markers, grown by a number of twentieths of a cell on a fine grid.
double DarkCells(const ClipScene& scene, int twentieths) {
  double area = 0;
  for (const ClipMarker& marker : scene.markers) {
    cv::Mat dark = marker.cells == 0;
    cv::resize(dark, dark, {}, 20, 20, cv::INTER_NEAREST);
    cv::copyMakeBorder(dark, dark, 20, 20, 20, 20, cv::BORDER_CONSTANT, 0);
    const int size = 2 * std::abs(twentieths) + 1;
    const cv::Mat square = cv::Mat::ones(size, size, CV_8UC1);
    if (twentieths > 0) cv::dilate(dark, dark, square);
    if (twentieths < 0) cv::erode(dark, dark, square);
    area += cv::countNonZero(dark) / 400.0;
  }
  return area;
}

// From a flat marker's centre, along its first side, m.
double OutermostInk(const ClipMarker& marker) {
  const ClipVertex &left = marker.corners[0], &right = marker.corners[1];
  const Eigen::Vector3d along = (right.x_before_m - left.x_before_m).normalized();
  const Eigen::Vector3d centre =
      0.5 * (marker.corners[0].x_before_m + marker.corners[2].x_before_m);
  const int stride = marker.sheet.num_columns + 1;
  double reach_m = 0;
  for (int row = 0; row < marker.inked.rows; ++row) {
    for (int column = 0; column < marker.inked.cols; ++column) {
      if (marker.inked.at<std::uint8_t>(row, column) == 0) continue;
      const auto index = static_cast<std::size_t>(row * stride + column + 1);
      reach_m = std::max(reach_m, (marker.sheet.vertices[index].x_before_m - centre).dot(along));
    }
  }
  return reach_m;
}

TEST(SurfaceRendererTest, InkSpreadsByItsAmountAndLeavesTheTruth) {
  ClipOptions options = BoardOptions();
  const ClipScene plain = MakeClipScene(options);
  const double plain_area = InkedArea(options);
  for (const int twentieths : {-1, 1}) {
    options.ink_spread_mm = twentieths / 20.0 * 40 / 6;
    const ClipScene spread = MakeClipScene(options);
    EXPECT_NEAR(OutermostInk(spread.markers[3]), 0.02 + 1e-3 * options.ink_spread_mm, 1e-9);
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      EXPECT_EQ(spread.markers[3].corners[i].x_before_m, plain.markers[3].corners[i].x_before_m);
    }
    const double expected = DarkCells(plain, twentieths) / DarkCells(plain, 0);
    EXPECT_GT(std::abs(expected - 1), 0.05);
    EXPECT_NEAR(InkedArea(options) / plain_area, expected, 0.003);
  }
}

TEST(SurfaceRendererTest, MarginsHaveTheirWidth) {
  ClipOptions options = BoardOptions();
  const ClipScene scene = MakeClipScene(options);
  const double dark_sides2 = DarkCells(scene, 0) / 36 / static_cast<double>(scene.markers.size());
  for (const double margin : {0.05, 0.3}) {
    options.margin_sides = margin;
    const double expected = ((1 + 2 * margin) * (1 + 2 * margin) - dark_sides2) / dark_sides2;
    EXPECT_NEAR(PaperArea(options) / InkedArea(options), expected, 0.01);
  }
  options.margin_sides = 0.4;
  EXPECT_THROW(MakeClipScene(options), InputError);  // stickers overlap
}

TEST(SurfaceRendererTest, BackgroundIsOnlyBehindThePaper) {
  ClipOptions options = BoardOptions();
  const cv::Mat light = LightOfBoard(options, 0.1, 0.8);
  options.background_level = 0.2;
  const cv::Mat other = LightOfBoard(options, 0.1, 0.8);
  const ClipScene scene = MakeClipScene(options);
  for (const ClipMarker& marker : scene.markers) {
    const auto corners = ProjectCorners(scene, marker, 0);
    ASSERT_TRUE(corners);
    const Eigen::Vector2d middle = 0.5 * ((*corners)[0] + (*corners)[2]);
    const Eigen::Vector2d along = (*corners)[1] - (*corners)[0];
    const auto gray = [&](const cv::Mat& image, double sides) {
      const Eigen::Vector2d x = middle + sides * along;
      return static_cast<double>(
          image.at<std::uint8_t>(static_cast<int>(x.y()), static_cast<int>(x.x())));
    };
    EXPECT_EQ(gray(other, -0.45), gray(light, -0.45));  // ink of the border
    EXPECT_EQ(gray(other, -0.58), gray(light, -0.58));  // paper
    EXPECT_NEAR(gray(other, -0.58) / gray(other, -0.72), 0.8 / 0.2, 0.08);
  }
}

// Every corner is where the camera sees it while its row is read, and the picture shows it there.
TEST(SurfaceRendererTest, RollingShutterSeesEachRowAtItsOwnTime) {
  ClipOptions options = BoardOptions();
  options.shake_deg = 2;
  const ClipScene at_once = MakeClipScene(options);
  options.rolling_shutter_s = 0.025;
  const ClipScene by_rows = MakeClipScene(options);
  const int frame_idx = 31;
  double largest_px = 0;
  for (const ClipMarker& marker : by_rows.markers) {
    const auto corners = ProjectCorners(by_rows, marker, frame_idx);
    const auto corners_at_once = ProjectCorners(at_once, marker, frame_idx);
    ASSERT_TRUE(corners && corners_at_once);
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const double row = (*corners)[i].y() / by_rows.camera.height_px;
      const double frame = frame_idx + (row - 0.5) * options.rolling_shutter_s * options.fps;
      const auto then = ImageFromCam(by_rows.camera,
                                     by_rows.cam_from_world(frame) * marker.corners[i].x_before_m);
      ASSERT_TRUE(then);
      EXPECT_LT(((*corners)[i] - *then).norm(), 1e-6);
      largest_px = std::max(largest_px, ((*corners)[i] - (*corners_at_once)[i]).norm());
    }
  }
  EXPECT_GT(largest_px, 1);
  const CornerErrors errors = DetectAndCompare(by_rows, {frame_idx});
  EXPECT_EQ(errors.num_markers, 12);
  EXPECT_LT(errors.rms_px, 0.05);
}

// Blur and motion blur mix light, so that a picture through the tone curve is the curve of the
// linear picture, pixel by pixel, and not a blurred picture of encoded values.
TEST(SurfaceRendererTest, ToneCurveComesAfterAllBlur) {
  const ClipScene scene = MakeClipScene(BoardOptions());
  SurfaceRenderOptions render = Noiseless();
  render.motion_blur_px = 2;
  const cv::Mat linear = RenderClipFrame(scene, render, 7);
  render.response.tone_curve = ToneCurveKind::kSrgb;
  const cv::Mat encoded = RenderClipFrame(scene, render, 7);
  for (int row = 0; row < linear.rows; ++row) {
    for (int column = 0; column < linear.cols; ++column) {
      const int light = linear.at<cv::Vec3b>(row, column)[1];
      const int gray = encoded.at<cv::Vec3b>(row, column)[1];
      ASSERT_GE(gray, EncodeLight(render.response, light - 0.51) - 0.6);
      ASSERT_LE(gray, EncodeLight(render.response, light + 0.51) + 0.6);
    }
  }
}

TEST(SurfaceRendererTest, GlareIsTheSameLightEverywhere) {
  const ClipScene scene = MakeClipScene(BoardOptions());
  SurfaceRenderOptions render = Noiseless();
  const cv::Mat clear = RenderClipFrame(scene, render, 7);
  render.glare = 10.0 / 255;
  cv::Mat difference;
  cv::absdiff(RenderClipFrame(scene, render, 7), clear + cv::Scalar::all(10), difference);
  EXPECT_LE(cv::norm(difference, cv::NORM_INF), 1);
}

TEST(SurfaceRendererTest, ShadowsOnlyTakeLight) {
  const ClipScene scene = MakeClipScene(BoardOptions());
  SurfaceRenderOptions options = Noiseless();
  const cv::Mat sunny = RenderClipFrame(scene, options, 3);
  options.num_shadows = 6;
  const cv::Mat shaded = RenderClipFrame(scene, options, 3);
  const cv::Mat brighter = shaded > sunny, darker = shaded < sunny;
  EXPECT_EQ(cv::countNonZero(brighter.reshape(1)), 0);
  const double share =
      cv::countNonZero(darker.reshape(1)) / static_cast<double>(darker.total() * darker.channels());
  EXPECT_GT(share, 0.02);
  EXPECT_LT(share, 0.9);
  EXPECT_GT(cv::sum(shaded)[0], (1 - options.shadow_depth) * cv::sum(sunny)[0]);
  EXPECT_EQ(cv::norm(shaded, RenderClipFrame(scene, options, 3), cv::NORM_L1), 0);
}

}  // namespace
}  // namespace velamap
