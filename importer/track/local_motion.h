// How the picture has moved around a place, by the markers found before and after.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace velamap {

// One point of the picture in two frames, px.
struct PointMotion {
  Eigen::Vector2d from_px;
  Eigen::Vector2d to_px;
};

// Displacement (px) of `point_px` by a similarity through the nearest of `motions`. A turn or a
// change of scale is held small where those stand close together. Zero without any.
Eigen::Vector2d LocalMotion(const std::vector<PointMotion>& motions,
                            const Eigen::Vector2d& point_px);

}  // namespace velamap
