// Angles between directions, and the rotations of a cube onto itself.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace velamap {

// In rad, 0 to pi. Unlike the arc cosine, accurate for small angles. The vectors need not have unit
// length.
double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

// The 24 rotations of a cube onto itself.
std::vector<Eigen::Matrix3d> CubeRotations();

}  // namespace velamap
