// Pi, and the factors between the units of the computation (m, rad) and of the reports (mm, deg).

#pragma once

namespace velamap {

inline constexpr double kMmPerM = 1e3;
inline constexpr double kMPerMm = 1e-3;
inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDegPerRad = 180 / kPi;
inline constexpr double kRadPerDeg = kPi / 180;

}  // namespace velamap
