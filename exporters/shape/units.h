// Factors between the units of the computation (m, rad) and those of the reports (mm, deg).

#pragma once

namespace velamap {

inline constexpr double kMmPerM = 1e3;
inline constexpr double kMPerMm = 1e-3;
inline constexpr double kDegPerRad = 180 / 3.14159265358979323846;

}  // namespace velamap
