// Limits by which clip_checker judges a clip and shoot_planner a plan.

#pragma once

namespace velamap {

// Sides of markers in the picture: corner fits reach their precision from 25 px on and lose markers
// below 12.
inline constexpr double kGoodSidePx = 20.0, kBadSidePx = 12.0;
// Below the first parallax, depth is several times less certain than width; below the second, it is
// hopeless.
inline constexpr double kGoodParallax_deg = 20.0, kBadParallax_deg = 8.0;

}  // namespace velamap
