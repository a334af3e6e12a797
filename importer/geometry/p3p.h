// Poses of a camera from three points and their rays, and random samples for them.

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "importer/geometry/rigid3.h"

namespace velamap {

// Up to four cam_from_world, all finite, by AP3P (Ke and Roumeliotis, "An Efficient Algebraic
// Solution to the Perspective-Three-Point Problem", CVPR 2017) in cv::solveP3P. `rays` are (x/z,
// y/z) in the cam frame.
std::vector<Rigid3> SolveP3P(const std::array<Eigen::Vector3d, 3>& x_in_world,
                             const std::array<Eigen::Vector2d, 3>& rays);

struct SampledCorner {
  std::size_t marker_idx, corner_idx;
};

// A random corner of each of three random markers; nothing if a marker was drawn twice.
std::optional<std::array<SampledCorner, 3>> SampleCorners(std::size_t num_markers,
                                                          std::mt19937* generator);

}  // namespace velamap
