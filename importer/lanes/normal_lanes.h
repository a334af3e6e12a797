// The normal distribution and its density, which blurred edges need thousands of times for a
// marker.

#pragma once

#include <cstring>

#include "importer/lanes/float_lanes.h"

namespace velamap {

// exp(x) for -80 < x <= 0 to a relative error of 3e-6: a power of two times a Taylor series.
inline Floats ExpOfNegative(Floats x) {
  constexpr float kLog2E = 1.44269504f, kLn2 = 0.693147181f;
  const Ints power =
      __builtin_convertvector(x * kLog2E - 0.5f, Ints);  // truncation rounds to the nearest
  const Floats rest = x - __builtin_convertvector(power, Floats) * kLn2;
  const Floats series =
      1.0f +
      rest * (1.0f + rest * (0.5f + rest * (1.0f / 6 + rest * (1.0f / 24 + rest * (1.0f / 120)))));
  const Ints bits = (power + 127) << 23;
  Floats scale;
  std::memcpy(&scale, &bits, sizeof(scale));
  return scale * series;
}

struct NormalLanes {
  Floats distribution, density;
};

// Abramowitz and Stegun, Handbook of Mathematical Functions, 26.2.17; good to 1e-6.
inline NormalLanes NormalAt(Floats z) {
  const Floats size = Min(Abs(z), AllLanes(8.0));
  const Floats density = 0.39894228f * ExpOfNegative(-0.5f * size * size);
  const Floats t = 1.0f / (1.0f + 0.2316419f * size);
  const Floats tail =
      density * t *
      (0.319381530f +
       t * (-0.356563782f + t * (1.781477937f + t * (-1.821255978f + t * 1.330274429f))));
  return {z < 0.0f ? tail : 1.0f - tail, density};
}

}  // namespace velamap
