// The local motion of the picture, from the markers found in both of two frames.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace velamap {

// One point of the picture in two frames, px.
struct PointMotion {
  Eigen::Vector2d from_px;
  Eigen::Vector2d to_px;
};

// Displacement (px) of `point_px` by a similarity fitted to the nearest of `motions`. Rotation and
// change of scale are regularized where the motions lie close together. Zero without motions.
Eigen::Vector2d LocalMotion(const std::vector<PointMotion>& motions,
                            const Eigen::Vector2d& point_px);

}  // namespace velamap
