// What the tests of the database write and compare.

#pragma once

#include <filesystem>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "importer/camera/camera.h"
#include "importer/detect/detection.h"
#include "tests/importer/marker_builders.h"
#include "tests/support/temp_dir.h"

namespace velamap {

inline const Camera kDatabaseCamera{
    CameraModel::kOpenCV, 1920, 1080, {1400.1, 1410, 960, 540, .1, .2, .3, .4}};

inline FrameDetections SomeDetections(const std::string& name) {
  FrameDetections detections;
  detections.image_name = name;
  detections.markers = {SquareMarker(2, 100.123456789, 50), SquareMarker(79, 300, 1.0 / 3.0)};
  detections.markers[0].part = "sail";
  detections.markers[0].colors[3] = {1, 20, 255};
  detections.markers[0].corner_sigma_px = {0.01, 0.02, 1.0 / 30, 0.04};
  detections.markers[1].is_fallback = true;
  detections.rejected = {{SquareMarker(5, 700, 700), "not in layout"}};
  return detections;
}

inline int NumFiles(const TempDir& dir) {
  return static_cast<int>(std::distance(std::filesystem::directory_iterator(dir.path()), {}));
}

inline void ExpectEqual(const MarkerDetection& a, const MarkerDetection& b) {
  EXPECT_EQ(a.marker_id, b.marker_id);
  EXPECT_EQ(a.corners_in_image_px, b.corners_in_image_px);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.part, b.part);
  EXPECT_EQ(a.corner_sigma_px, b.corner_sigma_px);
  EXPECT_EQ(a.is_fallback, b.is_fallback);
}

}  // namespace velamap
