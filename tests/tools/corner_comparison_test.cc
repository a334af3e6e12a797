#include "tests/support/study/corner_comparison.h"

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/geometry/quad.h"
#include "tests/support/clip/clip_files.h"
#include "tests/support/render/surface_renderer.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

// The true corners of all frames, each marker grown about its centre.
std::vector<DatabaseImage> Detections(const ClipScene& scene, double growth) {
  std::vector<DatabaseImage> images;
  for (int i = 0; i < scene.options.num_frames; ++i) {
    DatabaseImage image;
    image.detections.frame_number = i;
    for (const ClipMarker& marker : scene.markers) {
      const auto corners = ProjectCorners(scene, marker, i);
      if (!corners) continue;
      MarkerDetection detection;
      detection.marker_id = marker.marker_id;
      const Eigen::Vector2d middle = QuadCenter(*corners);
      for (std::size_t k = 0; k < kNumCorners; ++k) {
        detection.corners_in_image_px[k] = middle + growth * ((*corners)[k] - middle);
        detection.corner_sigma_px[k] = 0.05;
      }
      image.detections.markers.push_back(detection);
    }
    images.push_back(image);
  }
  return images;
}

class CompareCornersTest : public ::testing::Test {
 protected:
  CompareCornersTest() {
    ClipOptions options;
    options.kind = ClipKind::kWalls;
    options.distance_m = 3.5;
    options.num_frames = 3;
    scene_ = MakeClipScene(options);
    WriteClipFiles(scene_, dir_.path());
  }

  TempDir dir_;
  ClipScene scene_;
};

TEST_F(CompareCornersTest, TrueCornersHaveNoError) {
  const auto comparisons = CompareCorners(dir_.path(), Detections(scene_, 1.0));
  EXPECT_EQ(comparisons.size(), 3 * scene_.markers.size());
  for (const CornerComparison& one : comparisons) {
    EXPECT_NEAR(one.side_error_px, 0, 1e-9);
    EXPECT_NEAR(one.corner_error_px, 0, 1e-9);
    EXPECT_FALSE(one.is_false);
  }
}

TEST_F(CompareCornersTest, LargerMarkersAreSaidToBeLarger) {
  for (const CornerComparison& one : CompareCorners(dir_.path(), Detections(scene_, 1.02))) {
    EXPECT_NEAR(one.side_error_px, 0.02 * one.side_px, 1e-9);
    EXPECT_NEAR(one.error_over_sigma, one.corner_error_px / std::sqrt(2.0) / 0.05, 1e-9);
    EXPECT_GT(one.corner_error_px, 0.013 * one.side_px);
  }
}

TEST_F(CompareCornersTest, MarkersElsewhereAreFalse) {
  std::vector<DatabaseImage> images = Detections(scene_, 1.0);
  auto& markers = images[1].detections.markers;
  for (Eigen::Vector2d& corner : markers[0].corners_in_image_px) corner.x() += 200;
  markers[1].marker_id = 249;  // none of the clip
  int num_false = 0;
  for (const CornerComparison& one : CompareCorners(dir_.path(), images)) {
    num_false += one.is_false;
  }
  EXPECT_EQ(num_false, 2);
}

TEST_F(CompareCornersTest, PhotographsAreRefused) {
  std::vector<DatabaseImage> images = Detections(scene_, 1.0);
  images[2].detections.frame_number.reset();
  EXPECT_THROW(CompareCorners(dir_.path(), images), InputError);
}

}  // namespace
}  // namespace velamap
