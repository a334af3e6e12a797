// Surfaces, and how a printed sheet lies on them.

#pragma once

#include <functional>

#include <Eigen/Core>

namespace velamap {

// Maps (u, v) in [0, 1]^2 to a position in the world frame, m. For a viewer of the printed side, u
// grows to the right and v upwards. The function is twice differentiable.
using Surface = std::function<Eigen::Vector3d(const Eigen::Vector2d& uv)>;

// The end of the geodesic that starts at `uv` with the direction and length of `offset_m`. Its x is
// the direction of growing u, and y is upwards at a right angle to it. A sticker that is pressed on
// from its centre outwards without stretching lies along these geodesics.
Eigen::Vector2d WalkOnSurface(const Surface& surface, const Eigen::Vector2d& uv,
                              const Eigen::Vector2d& offset_m);

// A mainsail in the world frame, m. The foot is along x and the head up along z. The ends of the
// luff are at x = 0; between them the mast bends towards -x, by 60 mm at scale 1. The sail bulges
// towards -y, where the camera is, and its leech twists towards -y with height.
struct Mainsail {
  double scale = 1.0;       // of the size; 1 for a foot of 3 m and a luff of 6 m
  double camber = 0.10;     // depth / chord at the foot; 0.02 more at the head
  double twist_rad = 0.26;  // from foot to head, 15 degrees
};

// The chord at a height, m. `v` is a fraction of the luff.
double SailChord(const Mainsail& shape, double v);

// The sail; its sections are cubics with the deepest point at 40 % of the chord.
Surface MakeSail(const Mainsail& shape);

}  // namespace velamap
