// The metric result: positions of the corners and the centre of every marker.

#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/base/ids.h"

namespace velamap {

// Index 0 is the centre, the mean of the four corners; 1..4 are the corners. Shape frame, m.
struct ShapeMarker {
  int marker_id = 0;
  std::string part;
  std::array<std::optional<Eigen::Vector3d>, kNumCorners + 1> x_in_shape_m;
  // 1 sigma along x, y and z; nothing without a covariance.
  std::array<std::optional<Eigen::Vector3d>, kNumCorners + 1> sigma_m;
  std::array<int, kNumCorners + 1> num_frames{};  // for the centre, the minimum of its corners

  // Whether all four corners are known, and with them the centre.
  bool IsWhole() const { return x_in_shape_m[0].has_value(); }
};

struct MarkerShape {
  std::vector<ShapeMarker> markers;  // by ascending marker id
};

// The root mean square of the sigmas along x, y and z.
double SigmaOfCoordinate(const Eigen::Vector3d& sigma_m);

// The mean of the corners; nothing if one of them is unknown.
std::optional<Eigen::Vector3d> MeanOfCorners(const ShapeMarker& marker);

// Sets the centre and its number of frames from the corners; nothing if one of them is unknown.
void SetCenter(ShapeMarker* marker);

// Null without such a marker.
const ShapeMarker* FindMarker(const MarkerShape& shape, int marker_id);
// Null also for a marker that is not whole.
const ShapeMarker* FindWholeMarker(const MarkerShape& shape, int marker_id);

// Outward unit normal, z of the marker frame. The marker must be whole.
Eigen::Vector3d MarkerNormal(const ShapeMarker& marker);

// Unit vector from the bottom side of the upright marker to its top side. The marker must be whole.
Eigen::Vector3d MarkerUp(const ShapeMarker& marker);

// Area of the quadrilateral of the corners, m^2: half the length of the cross product of its
// diagonals (thesis section 4.3.2). The marker must be whole.
double MarkerArea(const ShapeMarker& marker);

// Lengths of the sides 1-2, 2-3, 3-4, 4-1, m. The marker must be whole.
std::array<double, kNumCorners> MarkerSides(const ShapeMarker& marker);
double MeanSide(const std::array<double, kNumCorners>& sides);

// Sides of a box around all corners, longest first, m. Boxes along the shape's principal axes and
// along the sides of each marker are tried, and the one with the smallest surface is taken. It fits
// a curved sheet as well as a cube and does not depend on the frame.
Eigen::Vector3d BoundingBox(const MarkerShape& shape);

}  // namespace velamap
