// The shape of the surface in a single frame: the points of its markers in the cam frame
// (thesis 3.3).

#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/database/colmap_database.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/layout.h"

namespace velamap {

// Centre (index 0) and corners 1..4 of one marker in a frame named by the variable, m.
using MarkerPoints = std::array<Eigen::Vector3d, kNumCorners + 1>;

// Points of all markers by marker id, in the shape frame, m.
using ShapePoints = std::map<int, MarkerPoints>;

MarkerPoints Transform(const Rigid3& b_from_a, const MarkerPoints& x_in_a);

// Root mean square distance of corresponding points, m.
double RmsDistance(const MarkerPoints& a, const MarkerPoints& b);

struct FrameMarker {
  int marker_id = 0;
  std::vector<MarkerPoints> x_in_cam;  // one or two solutions, better reprojection first
  std::array<Eigen::Vector2d, kNumCorners> corners_in_image_px;
  // Expected error of the distance from the camera, m: distance^2 * sigma_px / (focal * length) for
  // corners with a sigma of a quarter of a pixel. The error across the line of sight is far
  // smaller.
  double depth_sigma_m = 0.0;
};

struct FrameShape {
  ImageId image_id = 0;
  std::string image_name;
  std::optional<int> frame_number;
  std::vector<FrameMarker> markers;  // by ascending id
};

// Estimates the pose of every marker of the image alone, with its own length. Markers without a
// pose are left out.
FrameShape EstimateFrameShape(const DatabaseImage& image, const Camera& camera,
                              const Layout& layout);

}  // namespace velamap
