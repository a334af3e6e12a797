// What a clip has to have. clip_checker judges a clip by these limits, shoot_planner a plan.

#pragma once

namespace velamap {

// Sides of markers in the picture: corner fits reach their precision from 25 px on and lose markers
// below 12.
inline constexpr double kGoodSidePx = 20.0, kBadSidePx = 12.0;
// Parallax below which depth is several times less certain than width, and hopeless.
inline constexpr double kGoodParallax_deg = 20.0, kBadParallax_deg = 8.0;

}  // namespace velamap
