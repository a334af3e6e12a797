// Poses of a camera that three points in space and their rays allow, and how many triples to draw.

#pragma once

#include <array>
#include <cstddef>
#include <random>
#include <vector>

#include <Eigen/Core>

namespace velamap {

// cam_from_space; the rotation as axis times angle, rad.
struct TriplePose {
  Eigen::Vector3d rotation_vector;
  Eigen::Vector3d translation;
};

// At most four, all finite, by cv::solveP3P with AP3P. `rays` are (x/z, y/z) in the cam frame.
std::vector<TriplePose> PosesOfTriple(const std::array<Eigen::Vector3d, 3>& x_in_space,
                                      const std::array<Eigen::Vector2d, 3>& rays);

// So many triples as it takes that one draw in a billion has no right one, where the part
// `agreeing_part` of the points is right; within `min` and `max`.
int NumTriples(double agreeing_part, int min, int max);

// Below `size`. std::uniform_int_distribution differs between standard libraries; this does not.
std::size_t RandomIndex(std::mt19937* generator, std::size_t size);

}  // namespace velamap
