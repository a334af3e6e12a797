// Surfaces and how a printed sheet lies on them.

#pragma once

#include <functional>

#include <Eigen/Core>

namespace velamap {

// Position (m, world frame) of the place (u, v) in [0, 1]^2; u grows to the right and v upwards
// for one who looks at the face. Twice differentiable.
using Surface = std::function<Eigen::Vector3d(const Eigen::Vector2d& uv)>;

// End of the geodesic that starts at `uv` and covers `offset_m`, whose x points along growing u and
// whose y points upwards at a right angle to it. A sheet of cloth that is smoothed from its centre
// outwards without stretching lies like this.
Eigen::Vector2d WalkOnSurface(const Surface& surface, const Eigen::Vector2d& uv,
                              const Eigen::Vector2d& offset_m);

// A mainsail with its luff at x = 0, its foot along x and its head up z; it bulges to -y, where
// the camera is, and its leech opens towards -y with height. Lengths in m.
struct SailShape {
  double scale = 1.0;       // of the sail's size: 3 m foot, 6 m luff
  double camber = 0.10;     // depth over chord at the foot; 0.02 more at the head
  double twist_rad = 0.26;  // from foot to head, 15 degrees
};

// Chord at height v of the luff, m.
double SailChord(const SailShape& shape, double v);

// Section: a cubic with its deepest point at 40 % of the chord.
Surface MakeSail(const SailShape& shape);

}  // namespace velamap
