// Limits by which clip_checker judges a clip and shoot_planner a plan.

#pragma once

namespace velamap {

// Sides of markers in the picture: in a good clip, more than 99 % of the markers are found from 20
// px on. Below 12 px, more than a tenth are lost, and below 9 px more than half (the table of
// distances in sample_project/guide_sailor.md).
inline constexpr double kGoodSidePx = 20.0, kBadSidePx = 12.0;
// Below the first parallax, depth is several times less certain than width; below the second, it is
// hopeless.
inline constexpr double kGoodParallax_deg = 20.0, kBadParallax_deg = 8.0;

// Grey levels of the markers of a good clip, 0 to 255: brighter paper loses its edges, and less
// contrast its cells.
inline constexpr double kGoodContrast = 60.0, kMaxWhite = 250.0;

}  // namespace velamap
