// Renders single markers on cylinders, with exact truth.

#pragma once

#include <random>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/bend/pattern_bend.h"
#include "importer/camera/camera.h"
#include "importer/geometry/quad.h"
#include "importer/geometry/rigid3.h"

namespace velamap {

// A marker around an axis along its columns, convex for the camera. The origin of its frame (x
// right, y up, z out of the face) is the middle of the bent square.
struct BentMarker {
  double length_m = 0.1, radius_m = 0.25;
  Rigid3 cam_from_marker;
  cv::Mat cells;  // 8 bit, with the border; zero for black

  // The place of a point that lies at (x, y) before the marker is bent.
  Eigen::Vector3d Place(double x_m, double y_m) const;
};

struct BentMarkerView {
  Camera camera;
  cv::Mat gray;            // 8 bit: levels 40 and 200 on 120, one cell of quiet zone
  QuadCorners corners_px;  // truth, OpenCV's pixel frame
  PatternBend bend;        // truth
};

// A marker with random cells, a radius of 2 to 3 sides and a tilt of up to 50 degrees, about ten
// sides away from the camera.
BentMarker RandomBentMarker(std::mt19937* random);

// `noise`: standard deviation, grey levels.
BentMarkerView RenderBentMarker(const BentMarker& marker, double noise, std::mt19937* random);

}  // namespace velamap
