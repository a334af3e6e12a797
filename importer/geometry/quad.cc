#include "importer/geometry/quad.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace velamap {

Eigen::Vector2d QuadCenter(const QuadCorners& quad) {
  return 0.25 * (quad[0] + quad[1] + quad[2] + quad[3]);
}

double QuadMeanSide(const QuadCorners& quad) {
  double perimeter = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    perimeter += (quad[(i + 1) % kNumCorners] - quad[i]).norm();
  }
  return perimeter / kNumCorners;
}

double QuadArea(const QuadCorners& quad) {
  double doubled_area = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    doubled_area += Cross(quad[i], quad[(i + 1) % kNumCorners]);
  }
  return 0.5 * std::abs(doubled_area);
}

bool HasCells(const QuadCorners& quad, std::size_t num_cells) {
  return std::all_of(quad.begin(), quad.end(), [](const auto& x) { return x.allFinite(); }) &&
         QuadArea(quad) >= static_cast<double>(num_cells);
}

double MaxCornerShift(const QuadCorners& a, const QuadCorners& b) {
  double max_shift = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    max_shift = std::max(max_shift, (a[i] - b[i]).norm());
  }
  return max_shift;
}

Box BoundingBox(const QuadCorners& quad) {
  Box box{quad[0], quad[0]};
  for (const Eigen::Vector2d& corner : quad) {
    box.min = box.min.cwiseMin(corner);
    box.max = box.max.cwiseMax(corner);
  }
  return box;
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

std::optional<Eigen::Vector2d> Intersect(const ImageLine& a, const ImageLine& b) {
  Eigen::Matrix2d directions;
  directions << a.direction, -b.direction;
  if (std::abs(directions.determinant()) < 0.05) return std::nullopt;
  return a.point_px + a.direction * (directions.inverse() * (b.point_px - a.point_px)).x();
}

}  // namespace velamap
