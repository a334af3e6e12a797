// Geometry of a marker's outline in an image.

#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "importer/base/ids.h"

namespace velamap {

// Corners in OpenCV's pixel frame: (0,0) is the first pixel's centre. Order as in detection.h.
using QuadCorners = std::array<Eigen::Vector2d, kNumCorners>;

Eigen::Vector2d QuadCenter(const QuadCorners& quad);
double QuadMeanSide(const QuadCorners& quad);
double QuadArea(const QuadCorners& quad);  // never negative; of a quad without crossing sides

// Whether the corners are finite and the quad has an area of at least `num_cells` pixels.
bool HasCells(const QuadCorners& quad, std::size_t num_cells);

// The largest distance between corresponding corners, px.
double MaxCornerShift(const QuadCorners& a, const QuadCorners& b);

struct Box {
  Eigen::Vector2d min, max;
};

Box BoundingBox(const QuadCorners& quad);

// The third component of the cross product.
double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b);

struct ImageLine {
  Eigen::Vector2d point_px, direction;
};

// The directions are about unit vectors. Returns nothing if the lines are nearly parallel: the sine
// of the angle between them is below 0.05.
std::optional<Eigen::Vector2d> Intersect(const ImageLine& a, const ImageLine& b);

}  // namespace velamap
