// The resolution of coordinates that are stored as 32-bit floats: STL files hold such floats, and
// meshes are read through them.

#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace velamap {

// The program warns of coarser steps.
inline constexpr double kMaxFloatStep_m = 1e-5;

// Distance between neighbouring floats at the coordinate that is farthest from the origin, m.
// Returns nothing unless it exceeds kMaxFloatStep_m and the distance that the same points would
// have in a frame that begins at one of them. It is the same in any unit of length.
std::optional<double> CoarseFloatStep_m(const std::vector<Eigen::Vector3d>& points_m);

}  // namespace velamap
