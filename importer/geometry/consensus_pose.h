// Pose of a camera by the consensus of markers whose corners are known in space.

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "importer/geometry/quad.h"

namespace velamap {

// Corners of one marker in space, whatever its frame and unit, and as rays (x/z, y/z) in the cam
// frame.
struct MarkerRays {
  std::array<Eigen::Vector3d, kNumCorners> corners_in_space;
  QuadCorners rays;
};

// Fewer markers say nothing.
inline constexpr std::size_t kMinConsensus = 4;

struct ConsensusPose {
  Eigen::Isometry3d cam_from_space;
  std::vector<std::size_t> agreeing_idxs;  // of the markers, ascending
};

// RANSAC with AP3P (cv::solveP3P) over corners of three markers each, and Levenberg-Marquardt on
// all corners of those that agree: whose corners are all within a side of the marker from their
// places. Nothing unless four agree, and half of all. The same for the same markers in the same
// order.
std::optional<ConsensusPose> FindConsensusPose(std::vector<MarkerRays> markers);

}  // namespace velamap
