#include "reconstruct/camera/lens_bend_correction.h"

#include <gtest/gtest.h>

#include "importer/bend/pattern_bend.h"

namespace velamap {
namespace {

MarkerDetection LargeMarker(double sigma_px) {
  MarkerDetection marker;
  marker.corners_in_image_px = {{{900, 100}, {1000, 110}, {990, 210}, {890, 195}}};
  marker.corner_sigma_px.fill(sigma_px);
  return marker;
}

TEST(CorrectForLensBend, MovesFittedCornersAsFarAsTheBendHas) {
  const Camera fisheye{CameraModel::kOpenCVFisheye, 1400, 1000, {480, 480, 700, 500, 0, 0, 0, 0}};
  const Camera pinhole{CameraModel::kSimplePinhole, 1400, 1000, {480, 700, 500}};
  MarkerDetection fallback = LargeMarker(0.1);
  fallback.is_fallback = true;
  const FrameDetections detections{
      "a.png", {}, {}, {LargeMarker(0.02), fallback, LargeMarker(0)}, {}};
  std::vector<DatabaseImage> images = {{1, 1, detections}, {2, 2, detections}};
  CorrectForLensBend({{1, fisheye}, {2, pinhole}}, &images);
  // Far from the axis a fisheye compresses along the radius, so that the sides bulge outwards.
  const QuadCorners before = LargeMarker(0).corners_in_image_px;
  const QuadCorners& after = images[0].detections.markers[0].corners_in_image_px;
  EXPECT_LT(QuadMeanSide(after), QuadMeanSide(before) - 0.02);
  EXPECT_EQ(images[0].detections.markers[1].corners_in_image_px, before);
  EXPECT_EQ(images[0].detections.markers[2].corners_in_image_px, before);
  EXPECT_EQ(images[1].detections.markers[0].corners_in_image_px, before);
}

}  // namespace
}  // namespace velamap
