// Three orthogonal directions of a rigid part, from which the frame of the reference part is made.

#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "exporters/shape/marker_shape.h"

namespace velamap {

// Whether the directions are more than 3 degrees from parallel.
bool SpanPlane(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

struct PartAxes {
  Eigen::Vector3d center;
  std::array<Eigen::Vector3d, 3> axes;  // first to last marker, normal, across
  Eigen::Vector3d marker_up;            // sum of the markers' own y axes
  bool is_flat = true;                  // if false, the normal is the mean of the markers' normals
};

// `ids` are whole markers of the part, at least two. Returns nothing if the line from the first to
// the last is along the normal.
std::optional<PartAxes> FitPartAxes(const MarkerShape& shape, const std::vector<int>& ids);

// Index of the axis with the smallest angle to the direction, up to its sign, other than `except`
// (-1: of all).
int NearestAxis(const std::array<Eigen::Vector3d, 3>& axes, const Eigen::Vector3d& direction,
                int except);

}  // namespace velamap
