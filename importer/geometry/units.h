// Pi, and the factors between the units of the computation (m, rad) and others.

#pragma once

namespace velamap {

inline constexpr double kMmPerM = 1e3;
inline constexpr double kMPerMm = 1e-3;
inline constexpr double kMmPerInch = 25.4;
inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDegPerRad = 180 / kPi;
inline constexpr double kRadPerDeg = kPi / 180;

}  // namespace velamap
