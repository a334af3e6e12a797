// Shadows with soft edges, such as those of masts, stays and sheets on a sail, and light that falls
// off along a surface.

#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace velamap {

// A straight band across a surface. Places on the surface run from 0 to 1 along both sides.
struct Shadow {
  Eigen::Vector2d place;                 // of a point of its middle line, in the first frame
  Eigen::Vector2d direction;             // of that line
  Eigen::Vector2d motion_in_clip{0, 0};  // of the place; zero: still with the surface
  double width_m = 0.0;
  double edge_m = 0.0;  // sigma of the soft edges
  double depth = 0.0;   // share of the light that is missing in the middle
};

// Random shadows: from a stay's to those wider than a marker, from sharp to so soft that the light
// falls off over a whole marker; half of them move. `depth`: of the darkest.
std::vector<Shadow> DrawShadows(int num_shadows, double depth, std::uint32_t seed);

// Darkens a picture of surfaces (CV_32FC2: grey levels times opacity, opacity) by a shadow whose
// middle line goes through two places of the picture.
void AddShadow(const Shadow& shadow, const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px,
               double px_per_m, cv::Mat* surfaces);

}  // namespace velamap
