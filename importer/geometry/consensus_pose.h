// Pose of a camera by the consensus of markers whose corners are known in space.

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "importer/geometry/quad.h"
#include "importer/geometry/rigid3.h"

namespace velamap {

// Corners of one marker in space, in any frame and unit, and as rays (x/z, y/z) in the cam frame.
struct MarkerRays {
  std::array<Eigen::Vector3d, kNumCorners> corners_in_space;
  QuadCorners rays;
};

// The smallest number of markers that support a pose.
inline constexpr std::size_t kMinConsensus = 4;

struct ConsensusPose {
  Rigid3 cam_from_space;
  std::vector<std::size_t> agreeing_idxs;  // of the markers, ascending
};

// RANSAC with P3P over corners of three markers each, then Levenberg-Marquardt on all corners of
// the markers that agree: those whose corners all project to within the mean length of the marker's
// sides in the image. Returns nothing unless at least four markers and half of all agree. The same
// input gives the same result.
std::optional<ConsensusPose> FindConsensusPose(std::vector<MarkerRays> markers);

}  // namespace velamap
